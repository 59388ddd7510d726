//! The shape of a mode, and what contacts and bodies have to do with its growth.
//!
//! The real part of ū̇′·(4.1) says that growth (u̇′·M u̇′ + u′·A u′) is what contact forces bring in less what the body
//! damps. The force of the contact at its nodes is what the terms of the body leave there. Of heat likewise, with the
//! stored θ′·C θ′.

use std::collections::BTreeMap;

use faer::c64;

use super::eliminated::Functional;
use super::polynomial::{Forms, Polynomial};
use super::search::FoundPair;
use super::{Mode, ModeKind, ModeOrigin};
use crate::contact::{Contact, ContactBoundary};
use crate::discretization::Discretization;
use crate::linalg::BlockMatrix;
use crate::mesh::Mesh;
use crate::mesh::defects::components;

/// Shares of contacts and bodies.
pub(super) struct ModeShares<'a> {
    forms: &'a Forms,
    dim: usize,
    is_thermal: bool,
    contacts: usize,
    /// The contacts of each node of Γ_C.
    of_node: BTreeMap<u32, Vec<usize>>,
    /// Nodes of each body, and its name.
    bodies: Vec<(String, Vec<u32>)>,
}

impl<'a> ModeShares<'a> {
    pub fn new(
        discrete: &Discretization,
        boundary: &ContactBoundary,
        contacts: &[Contact],
        forms: &'a Forms,
        kind: ModeKind,
    ) -> ModeShares<'a> {
        let mut of_node: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
        for point in &boundary.points {
            for (node, _) in &point.nodes {
                let all = of_node.entry(boundary.nodes[*node]).or_default();
                if !all.contains(&point.contact) {
                    all.push(point.contact);
                }
            }
        }
        // What is left at a node of the cut of a sector is in part at the node that follows it.
        for link in discrete.v.links.iter().chain(&discrete.q.links) {
            let both = [link.node, link.to];
            if let Some(all) = both.iter().find_map(|node| of_node.get(node).cloned()) {
                for node in both {
                    of_node.entry(node).or_insert_with(|| all.clone());
                }
            }
        }
        let is_thermal = kind == ModeKind::Thermal;
        let bodies = bodies(&discrete.mesh);
        ModeShares { forms, dim: discrete.mesh.dim, is_thermal, contacts: contacts.len(), of_node, bodies }
    }

    /// Names of the bodies.
    pub fn names(&self) -> Vec<String> {
        self.bodies.iter().map(|(name, _)| name.clone()).collect()
    }

    /// The mode of an eigenpair.
    pub fn mode(&self, pencil: &Polynomial, pair: &FoundPair) -> Mode {
        let left: Vec<c64> = pair.x.iter().zip(&pencil.scale).map(|(x, scale)| *x * *scale).collect();
        let x = pencil.trial.expand(&left);
        let at = |of: &[Functional]| -> Vec<c64> {
            of.iter().map(|row| row.iter().map(|&(k, factor)| x[k as usize] * factor).sum()).collect()
        };
        let (mut u, mut theta) = (at(&pencil.unknowns.u), at(&pencil.unknowns.theta));
        let leading = if self.is_thermal && theta.iter().any(|t| t.norm() > 0.0) { &theta } else { &u };
        let largest = leading.iter().copied().fold(c64::default(), |a, b| if b.norm() > a.norm() { b } else { a });
        for value in u.iter_mut().chain(&mut theta) {
            *value /= largest;
        }
        let (by_contact, by_body) = self.of(pair.lambda, &u, &theta);
        let parts = |values: &[c64]| values.iter().map(|value| [value.re, value.im]).collect();
        Mode {
            growth: pair.lambda.re,
            frequency: pair.lambda.im,
            waves: None,
            residual: pair.residual,
            by_contact,
            by_body,
            displacement: parts(&u),
            temperature: parts(&theta),
            slopes: Vec::new(),
            origin: ModeOrigin::default(),
        }
    }

    /// The shares of contacts in 1/s, and those of bodies.
    fn of(&self, lambda: c64, u: &[c64], theta: &[c64]) -> (Vec<f64>, Vec<f64>) {
        let forms = self.forms;
        let one = c64::new(1.0, 0.0);
        let (rate, size, left, field): (Vec<c64>, f64, Vec<c64>, usize) = if self.is_thermal {
            let mut left = vec![c64::default(); theta.len()];
            add(&mut left, lambda, forms.storage.as_ref(), theta, 1);
            forms.conduction.iter().for_each(|form| add(&mut left, one, Some(form), theta, 1));
            add(&mut left, -one, forms.heat.as_ref().filter(|_| !u.is_empty()), u, self.dim);
            (theta.to_vec(), energy(forms.storage.as_ref(), theta, 1), left, 1)
        } else {
            let v: Vec<c64> = u.iter().map(|u| lambda * *u).collect();
            let mut left = vec![c64::default(); u.len()];
            add(&mut left, lambda, forms.inertia.as_ref(), &v, self.dim);
            add(&mut left, one, forms.damping.as_ref(), &v, self.dim);
            add(&mut left, one, forms.stiffness.as_ref(), u, self.dim);
            for (own, form) in &forms.branches {
                add(&mut left, lambda / (lambda + *own), Some(form), u, self.dim);
            }
            add(&mut left, -one, forms.force.as_ref(), theta, 1);
            let size = energy(forms.inertia.as_ref(), &v, self.dim) + energy(forms.stiffness.as_ref(), u, self.dim);
            (v, size, left, self.dim)
        };
        let mut by_contact = vec![0.0; self.contacts];
        for (node, contacts) in &self.of_node {
            let power: f64 = (*node as usize * field..(*node as usize + 1) * field)
                .map(|dof| (rate[dof].conj() * left[dof]).re)
                .sum();
            for contact in contacts {
                by_contact[*contact] += power / (size * contacts.len() as f64);
            }
        }
        let form = if self.is_thermal { forms.storage.as_ref() } else { forms.inertia.as_ref() };
        let mut stored = vec![c64::default(); rate.len()];
        add(&mut stored, one, form, &rate, field);
        let of_body = |nodes: &[u32]| -> f64 {
            let dofs = nodes.iter().flat_map(|node| *node as usize * field..(*node as usize + 1) * field);
            dofs.map(|dof| (rate[dof].conj() * stored[dof]).re).sum()
        };
        let bodies: Vec<f64> = self.bodies.iter().map(|(_, nodes)| of_body(nodes)).collect();
        let all: f64 = bodies.iter().sum();
        (by_contact, bodies.into_iter().map(|own| if all > 0.0 { own / all } else { 0.0 }).collect())
    }
}

/// The product of a form with each part of a vector of `components` per node, added to a vector.
fn add(sum: &mut [c64], factor: c64, form: Option<&BlockMatrix>, x: &[c64], components: usize) {
    let Some(form) = form.filter(|_| !x.is_empty()) else { return };
    let _ = components;
    let part = |of: fn(&c64) -> f64| form.apply(&x.iter().map(of).collect::<Vec<f64>>());
    let (real, imaginary) = (part(|x| x.re), part(|x| x.im));
    for (sum, (re, im)) in sum.iter_mut().zip(real.into_iter().zip(imaginary)) {
        *sum += factor * c64::new(re, im);
    }
}

/// x̄·F x, which is real.
fn energy(form: Option<&BlockMatrix>, x: &[c64], components: usize) -> f64 {
    let mut product = vec![c64::default(); x.len()];
    add(&mut product, c64::new(1.0, 0.0), form, x, components);
    x.iter().zip(&product).map(|(x, product)| (x.conj() * *product).re).sum()
}

/// The connected parts of a mesh with their names: those of the regions of their first cells, numbered if several have
/// the same.
fn bodies(mesh: &Mesh) -> Vec<(String, Vec<u32>)> {
    let mut found: Vec<(String, Vec<u32>)> = Vec::new();
    for part in components(mesh) {
        let own = |node: &u32| part.nodes.binary_search(node).is_ok();
        let block = mesh.blocks.iter().find(|block| block.nodes.iter().take(1).any(own) || block.nodes.iter().any(own));
        let region = block.and_then(|block| mesh.regions.get(block.region)).cloned();
        let region = region.unwrap_or_else(|| "body".to_owned());
        let same = found.iter().filter(|(name, _)| name.split(' ').next() == Some(&region)).count();
        let name = if same == 0 { region } else { format!("{region} {}", same + 1) };
        found.push((name, part.nodes));
    }
    found
}
