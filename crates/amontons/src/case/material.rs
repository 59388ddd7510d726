//! The materials of a case.

use std::sync::Arc;

use super::build::{Build, Inertia};
use super::coefficient::{Plan, Refusal, Sites};
use super::elasticity::{self, Dimensions, ElasticLaw};
use super::library;
use super::place::At;
use super::raw::{self, Coefficient, Elasticity, Expansion, ExpansionKind, Orientation, Tensor};
use crate::field::{self, Field, Law};
use crate::material::{Dilatation, Isotropic, Material, Prony, StressState, TensorLaw};
use crate::mesh::{Mesh, PlaneState};
use crate::problem::Choice;
use crate::tensor::{Point, Rotation, Sym, mandel_len};

fn dilatation(raw: raw::Dilatation) -> Dilatation {
    match raw {
        raw::Dilatation::Full => Dilatation::Full,
        raw::Dilatation::Mean => Dilatation::Mean,
    }
}

impl Build<'_> {
    /// Builds the material at `prefix` of the case, which fills these regions. Faults go to the findings.
    pub fn material(&mut self, raw: &raw::Material, prefix: &str, mesh: &Mesh, regions: &[usize]) -> Material {
        let sites = Sites::new(|| regions.iter().flat_map(|&region| mesh.sites(Some(region))).collect());
        let is_tangent = raw.expansion_kind == Some(ExpansionKind::Tangent);
        // A stress state reported at a wrong place is not reported missing.
        let stands_in = raw.base.as_ref().map(|name| !library::materials().contains_key(name));
        let is_stand_in = stands_in.unwrap_or(raw.stress_state.is_some());
        let has_base = raw.base.is_some();
        MaterialBuilder { prefix, mesh, sites, has_base, is_stand_in, is_tangent, build: self }.material(raw)
    }
}

/// Value of a tensor at points where it does not exist.
const NOWHERE: Sym = Sym([f64::NAN; 6]);

/// Keys of data that do not depend on the temperature, with all keys below them.
const STEADY: [&str; 3] = ["density", "coupling", "prony"];

struct MaterialBuilder<'a, 'b, 'd> {
    prefix: &'a str,
    mesh: &'a Mesh,
    sites: Sites<'a>,
    /// True if it is based on a material of the library, and if that is a placeholder for an unknown name.
    has_base: bool,
    is_stand_in: bool,
    /// True if tables of thermal expansion hold tangent coefficients.
    is_tangent: bool,
    build: &'b mut Build<'d>,
}

impl MaterialBuilder<'_, '_, '_> {
    fn path(&self, key: &str) -> String {
        format!("{}.{key}", self.prefix)
    }

    fn note(&mut self, key: &str, found: String, expected: impl Into<String>, hint: Option<&str>) {
        let path = self.path(key);
        self.build.note(&path, At::Value, found, expected, hint);
    }

    /// Builds the material. Missing keys count as zero; missing required keys are noted elsewhere.
    fn material(mut self, raw: &raw::Material) -> Material {
        let dim = self.dim();
        let state =
            raw.elasticity.as_ref().map_or_else(StressState::default, |elasticity| self.stress_state(elasticity));
        let none = || Law::from(Isotropic::lame(dim, 0.0, 0.0, state));
        let plans = raw.elasticity.as_ref().map(|elasticity| self.elasticity(elasticity, state));
        let before = self.build.findings.len();
        let elasticity = plans.as_ref().map_or_else(none, |[law, _]| self.law("elasticity", law));
        let plans = plans.filter(|_| self.build.findings.len() == before);
        let viscosity = raw.viscosity.as_ref().map_or_else(none, |viscosity| {
            let (fields, make) = self.viscosity(viscosity, state);
            self.law("viscosity", &Plan::new(fields, make))
        });
        let expansion = self.expansion(raw, plans.as_ref(), elasticity.as_ref(), state);
        let coupling =
            raw.coupling.as_ref().map_or(Sym::ZERO.into(), |coupling| self.tensor("coupling", coupling, None, false));
        let heat_capacity = self.number("heat_capacity", raw.heat_capacity.as_ref());
        let conductivity = raw.conductivity.as_ref().map_or(Sym::ZERO.into(), |conductivity| {
            let conductivity = self.tensor("conductivity", conductivity, None, true);
            self.check_steady(&conductivity, &heat_capacity);
            conductivity
        });
        let prony = self.prony(raw, &elasticity, state);
        let density = self.number("density", raw.density.clone().map(Into::into).as_ref());
        self.build.densities.insert(self.prefix.to_owned(), density.clone());
        Material {
            density: match self.build.inertia {
                Inertia::Acts => density,
                Inertia::Ignored => 0.0.into(),
            },
            heat_capacity,
            elasticity,
            viscosity,
            prony,
            expansion,
            coupling,
            conductivity,
            dilatation: dilatation(raw.dilatation),
        }
    }

    /// Dimension of the tensors.
    fn dim(&self) -> usize {
        self.mesh.tensor_dim()
    }

    fn number(&mut self, key: &str, raw: Option<&Coefficient>) -> field::Coefficient<f64> {
        raw.map_or(0.0.into(), |raw| self.field(key, raw).into())
    }

    fn field(&mut self, key: &str, raw: &Coefficient) -> Field {
        let path = self.path(key);
        if STEADY.iter().any(|steady| key.starts_with(steady)) {
            return self.build.steady_coefficient(&path, raw, &self.sites);
        }
        let field = self.build.thermal_coefficient(&path, raw, &self.sites);
        if key.starts_with("expansion") { self.secant(key, field) } else { field }
    }

    /// A secant coefficient of thermal expansion: the mean of the tangent coefficients from 0 to θ.
    fn secant(&mut self, key: &str, field: Field) -> Field {
        let Field::Thermal(table) = &field else { return field };
        if !self.is_tangent {
            return field;
        }
        if let (Some(&first), Some(&last)) = (table.temperatures().first(), table.temperatures().last())
            && !(first..=last).contains(&0.0)
        {
            let hint = "extend the table to θ = 0, at which nothing is expanded";
            let found = format!("tangent coefficients from θ = {first:?} to θ = {last:?}");
            self.note(key, found, "a table that covers θ = 0", Some(hint));
            return Field::ZERO;
        }
        Field::Thermal(table.clone().mean())
    }

    fn fields<'c>(&mut self, keys: impl IntoIterator<Item = (String, &'c Coefficient)>) -> Vec<Field> {
        keys.into_iter().map(|(key, raw)| self.field(&key, raw)).collect()
    }

    /// The law of a plan, or a placeholder if it does not exist.
    fn law(&mut self, key: &str, plan: &Plan<ElasticLaw>) -> Law<dyn TensorLaw> {
        let (dim, path) = (self.dim(), self.path(key));
        let nowhere = Arc::new(Isotropic::lame(dim, f64::NAN, f64::NAN, StressState::PlaneStress));
        let law = self.build.law(&path, plan, &self.sites, nowhere);
        law.unwrap_or_else(|| Isotropic::lame(dim, 0.0, 1.0, StressState::PlaneStress).into())
    }

    /// The stress state of a plane body or a line. For a body with three dimensions a given one is a fault.
    fn stress_state(&mut self, raw: &Elasticity) -> StressState {
        let (Elasticity::Isotropic { stress_state, .. }
        | Elasticity::Orthotropic { stress_state, .. }
        | Elasticity::Anisotropic { stress_state, .. }
        | Elasticity::VonMisesProjection { stress_state, .. }
        | Elasticity::Hencky { stress_state, .. }) = raw;
        if stress_state.is_some() && self.dim() == 3 {
            let body = if self.mesh.axisymmetric { "a body of revolution" } else { "a body in space" };
            self.note(
                "elasticity.stress_state",
                format!("a stress state of {body}"),
                "one of a plane body or a line",
                Some("remove it"),
            );
        }
        let of_file = match self.build.of_file.plane {
            Some(PlaneState::Stress) => Some(StressState::PlaneStress),
            Some(PlaneState::Strain) => Some(StressState::PlaneStrain),
            None => None,
        };
        let given = stress_state.map(|given| match given {
            raw::StressState::PlaneStress => StressState::PlaneStress,
            raw::StressState::PlaneStrain => StressState::PlaneStrain,
        });
        if given.or(of_file).is_none() && self.dim() == 2 && !self.is_stand_in {
            self.no_stress_state();
        }
        if given.is_none() && self.dim() < 3 {
            let (value, why) = match of_file {
                Some(StressState::PlaneStrain) => ("plane-strain", "the elements of the mesh file say so"),
                Some(StressState::PlaneStress) => ("plane-stress", "the elements of the mesh file say so"),
                None => ("plane-stress", "a line is a bar, whose sides are free"),
            };
            self.build.chosen.push(Choice::new(self.path("elasticity.stress_state"), value, why));
        }
        given.or(of_file).unwrap_or_default()
    }

    /// Notes that the stress state of a plane body is missing. There is no default: both are common, and their
    /// stiffnesses differ by 1/(1 − ν²).
    fn no_stress_state(&mut self) {
        let key = if self.has_base { "stress_state" } else { "elasticity.stress_state" };
        let path = self.path(key);
        let hint =
            "\"plane-stress\" is a thin sheet whose faces are free, \"plane-strain\" a long body whose ends are held";
        let named = "a material by its name is { base = NAME, stress_state = … } then; ";
        let hint = if self.has_base { format!("{named}{hint}") } else { hint.to_owned() };
        let expected = "\"plane-stress\" or \"plane-strain\" of a plane body";
        self.build.note(&path, At::Missing, "no such key", expected, Some(&hint));
    }

    /// The law of elasticity in the dimension of the body, and in three dimensions.
    fn elasticity(&mut self, raw: &Elasticity, state: StressState) -> [Plan<ElasticLaw>; 2] {
        let fields = self.fields(elasticity::elastic_coefficients(raw));
        if let Elasticity::Orthotropic { orientation, .. } | Elasticity::Anisotropic { orientation, .. } = raw {
            self.check_orientation("elasticity.orientation", orientation);
        }
        let dim = self.dim();
        [dim, 3].map(|in_dim| {
            let shape = Dimensions { body: dim, dim: in_dim, state };
            Plan::new(fields.clone(), elasticity::elastic_law(raw, shape))
        })
    }

    fn viscosity(
        &mut self,
        raw: &raw::Viscosity,
        state: StressState,
    ) -> (Vec<Field>, impl Fn(&[f64]) -> Result<ElasticLaw, Refusal> + Send + Sync + use<>) {
        let fields = self.fields(elasticity::viscous_coefficients(raw));
        if let raw::Viscosity::Anisotropic { orientation, .. } = raw {
            self.check_orientation("viscosity.orientation", orientation);
        }
        let dim = self.dim();
        (fields, elasticity::viscous_law(raw, Dimensions { body: dim, dim, state }))
    }

    fn prony(&mut self, raw: &raw::Material, elasticity: &Law<dyn TensorLaw>, state: StressState) -> Option<Prony> {
        if raw.prony.is_empty() {
            return None;
        }
        if !elasticity.temperatures().is_empty() {
            let expected = "an elasticity that does not depend on the temperature: branches are multiples of it";
            self.note("prony", "branches besides an elasticity over the temperature".to_owned(), expected, None);
            return None;
        }
        let mut branches = Vec::new();
        for (i, branch) in raw.prony.iter().enumerate() {
            let ratio = self.number(&format!("prony[{i}].ratio"), Some(&branch.ratio.clone().into()));
            let time = self.number(&format!("prony[{i}].time"), Some(&branch.time.clone().into()));
            let law = if branch.deviatoric { self.shear(i, raw, elasticity, state)? } else { elasticity.clone() };
            branches.push((law, ratio, time));
        }
        let varies = elasticity.graded().is_some() || branches.iter().any(|(_, g, tau)| g.varies() || tau.varies());
        let points = if varies { self.sites.points() } else { &[] };
        match Prony::varying(&branches, points) {
            Ok(prony) => Some(prony),
            Err(error) => {
                let refusal = elasticity::refusal(&error);
                self.note("prony", refusal.found, refusal.expected, None);
                None
            }
        }
    }

    /// The deviatoric part of an isotropic 𝓔, for a branch.
    fn shear(
        &mut self,
        branch: usize,
        raw: &raw::Material,
        elasticity: &Law<dyn TensorLaw>,
        state: StressState,
    ) -> Option<Law<dyn TensorLaw>> {
        let dim = self.dim();
        let refused = if !matches!(raw.elasticity, Some(Elasticity::Isotropic { .. })) {
            Some(("a deviatoric branch of an elasticity that is not isotropic", "`law = \"isotropic\"`"))
        } else if dim == 1 {
            Some(("a deviatoric branch on a line", "a body in the plane, of revolution or in space"))
        } else if dim == 2 && state == StressState::PlaneStress {
            let found = "a deviatoric branch in plane stress, where the thickness follows the relaxation";
            Some((found, "plane strain, a body of revolution or in space, or a branch of the whole 𝓔"))
        } else {
            None
        };
        if let Some((found, expected)) = refused {
            self.note(&format!("prony[{branch}].deviatoric"), found.to_owned(), expected, None);
            return None;
        }
        Some(elasticity.map(move |law, x| Arc::new(Isotropic::deviatoric(dim, law, x))))
    }

    /// Checks that a line has one angle only: the axes of its material can be turned about one axis.
    fn check_orientation(&mut self, key: &str, raw: &Orientation) {
        if self.mesh.dim == 1 && matches!(raw, Orientation::Euler(_)) {
            self.note(key, "three angles".to_owned(), "one angle: the body is a line", None);
        }
    }

    /// 𝓜 of (2.1), as given or from the coefficients of thermal expansion.
    fn expansion(
        &mut self,
        raw: &raw::Material,
        plans: Option<&[Plan<ElasticLaw>; 2]>,
        elasticity: &dyn TensorLaw,
        state: StressState,
    ) -> field::Coefficient<Sym> {
        if let (Some(coefficient), Some(law), Some(plans)) = (&raw.expansion_coefficient, &raw.elasticity, plans) {
            if raw.expansion.is_some() {
                let hint = "remove one of the two: 𝓜 = 𝓔α follows from the coefficient";
                self.note(
                    "expansion_coefficient",
                    "`expansion` besides it".to_owned(),
                    "either `expansion` or `expansion_coefficient`",
                    Some(hint),
                );
            }
            return self.thermal_stress((coefficient, law), plans, elasticity, state);
        }
        let Some(given) = &raw.expansion else { return Sym::ZERO.into() };
        self.tensor("expansion", given, Some(state), false)
    }

    /// 𝓜 = 𝓔α. In plane stress 𝓜 is 𝓔_red α_red: the strain that makes σ₃₃ vanish includes α₃₃. Otherwise the strain is
    /// plane, and 𝓜 is the in-plane part, with 33, of the product in three dimensions.
    fn thermal_stress(
        &mut self,
        (coefficient, raw): (&Expansion, &Elasticity),
        [reduced, in_space]: &[Plan<ElasticLaw>; 2],
        elasticity: &dyn TensorLaw,
        state: StressState,
    ) -> field::Coefficient<Sym> {
        let dim = self.dim();
        let is_plane_stress = dim < 3 && state == StressState::PlaneStress;
        if !elasticity.is_linear() && (is_plane_stress || !matches!(coefficient, Expansion::Isotropic(_))) {
            let expected = "one number in space, in plane strain or for a body of revolution: with this law 𝓜 depends on the strain otherwise";
            self.note(
                "expansion_coefficient",
                "a law of elasticity that is not linear".to_owned(),
                expected,
                Some("give `expansion`, the tensor 𝓜"),
            );
            return Sym::ZERO.into();
        }
        let key = "expansion_coefficient";
        let mut fields = match coefficient {
            Expansion::Isotropic(alpha) => vec![self.field(key, alpha)],
            Expansion::Orthotropic(along) => {
                along.iter().enumerate().map(|(i, alpha)| self.field(&format!("{key}[{i}]"), alpha)).collect()
            }
        };
        let along = fields.len();
        let angles = elasticity::angles_from(raw);
        let law = if is_plane_stress { reduced.clone() } else { in_space.clone() };
        fields.extend(law.fields().iter().cloned());
        let last = match (dim, state) {
            (2, StressState::PlaneStrain) => 4,
            _ => mandel_len(dim),
        };
        let (revolves, made) = (self.mesh.axisymmetric, law);
        let plan = Plan::new(fields, move |values| {
            let (given, of_law) = values.split_at(along);
            let axes = angles.map_or(Rotation::in_plane(0.0), |first| elasticity::rotation(&of_law[first..]));
            let mut alpha = match *given {
                [first, second, third] => Sym::principal(&[first, second, third], &axes),
                _ => given[0] * Sym::identity(3),
            };
            if is_plane_stress {
                alpha.0[mandel_len(dim)..].fill(0.0);
            }
            // A nonlinear law is isotropic here, and linear in the volume change.
            let mut thermal = made.of(of_law)?.tangent(&[0.0; 3], &Sym::ZERO).apply(&alpha);
            thermal.0[last..].fill(0.0);
            untwisted(thermal, revolves)
        });
        self.coefficient(key, &plan).unwrap_or(Sym::ZERO.into())
    }

    /// The tensor of a plan, fixed or varying, or `None`, with a note, if it does not exist.
    fn coefficient(&mut self, key: &str, plan: &Plan<Sym>) -> Option<field::Coefficient<Sym>> {
        let path = self.path(key);
        if !self.build.holds(&path, plan, &self.sites) {
            return None;
        }
        if !plan.varies() {
            return plan.at(&[0.0; 3], 0.0).ok().map(Into::into);
        }
        let plan = plan.clone();
        if plan.warms() {
            let temperatures = plan.temperatures().to_vec();
            let at = move |x: &Point, theta: f64| plan.at_temperature(x, 0.0, theta).unwrap_or(NOWHERE);
            return Some(field::Coefficient::of_temperature(&temperatures, at));
        }
        Some(field::Coefficient::varying(move |x| plan.at(x, 0.0).unwrap_or(NOWHERE)))
    }

    /// The symmetric tensor of a key, in a body of revolution by r, z, θ. With a stress state it is 𝓜; in plane strain
    /// a multiple of the identity then acts on the third direction too. With `conducts` negative eigenvalues are
    /// refused.
    fn tensor(
        &mut self,
        key: &str,
        raw: &Tensor,
        state: Option<StressState>,
        conducts: bool,
    ) -> field::Coefficient<Sym> {
        let (dim, revolves) = (self.dim(), self.mesh.axisymmetric);
        let check = move |tensor: Sym| {
            let tensor = untwisted(tensor, revolves)?;
            if conducts { conducting(tensor, dim) } else { Ok(tensor) }
        };
        let plan = match raw {
            Tensor::Multiple(factor) => {
                // The thermal expansion in the third direction is held at 0 by σ₃₃.
                let in_space = dim == 2 && state == Some(StressState::PlaneStrain);
                Plan::new(vec![self.field(key, factor)], move |values| {
                    let mut tensor = values[0] * Sym::identity(dim);
                    if in_space {
                        tensor.0[3] = values[0];
                    }
                    check(tensor)
                })
            }
            Tensor::Matrix(rows) => {
                let shape = if rows.len() == dim {
                    let other = rows.iter().enumerate().find(|(_, row)| row.len() != dim);
                    other.map(|(i, row)| format!("a row {} of length {}", i + 1, row.len()))
                } else {
                    Some(format!("a matrix of {} rows", rows.len()))
                };
                if let Some(found) = shape {
                    self.note(key, found, expected_tensor(dim), None);
                    return Sym::identity(dim).into();
                }
                let entries = rows.iter().enumerate().flat_map(|(i, row)| {
                    row.iter().enumerate().map(move |(j, entry)| (format!("{key}[{i}][{j}]"), entry))
                });
                let fields = self.fields(entries.collect::<Vec<_>>());
                Plan::new(fields, move |values| check(symmetric(values, dim)?))
            }
        };
        self.coefficient(key, &plan).unwrap_or(Sym::identity(dim).into())
    }

    /// Checks that steady heat has a conductivity.
    fn check_steady(&mut self, k: &field::Coefficient<Sym>, heat_capacity: &field::Coefficient<f64>) {
        let (Some(k), Some(0.0)) = (k.constant(), heat_capacity.constant()) else { return };
        if k.eigenvalues(self.dim()).last().is_none_or(|most| *most <= 0.0) {
            let hint = Some("give one of the two a positive value");
            self.note(
                "conductivity",
                "0 besides heat_capacity 0".to_owned(),
                "a positive conductivity if the heat is steady",
                hint,
            );
        }
    }
}

/// Expected text for a tensor.
fn expected_tensor(dim: usize) -> String {
    format!("a number or a symmetric {dim} × {dim} matrix")
}

/// The tensor, if it is admissible in a body of revolution: without components rθ and zθ.
fn untwisted(tensor: Sym, revolves: bool) -> Result<Sym, Refusal> {
    let twist = tensor.get(0, 2).abs().max(tensor.get(1, 2).abs());
    // Round-off of a rotation does not count.
    if !revolves || twist <= 8.0 * f64::EPSILON * tensor.norm() {
        return Ok(tensor);
    }
    let expected = "a tensor that is the same around the axis of a body of revolution";
    Err(Refusal::new("a component rθ or zθ", expected))
}

/// The tensor, if heat flows from warm to cold. A singular 𝓚 violates (H3) but can be computed with.
fn conducting(tensor: Sym, dim: usize) -> Result<Sym, Refusal> {
    let eigenvalues = tensor.eigenvalues(dim);
    let (least, most) =
        (eigenvalues.first().copied().unwrap_or_default(), eigenvalues.last().copied().unwrap_or_default());
    if least < -1e-12 * most.abs() {
        let expected = "no negative eigenvalue: heat flows from warm to cold";
        return Err(Refusal::new(format!("the eigenvalue {least:?}"), expected));
    }
    Ok(tensor)
}

/// The symmetric tensor with these entries, row by row.
fn symmetric(entries: &[f64], dim: usize) -> Result<Sym, Refusal> {
    let entry = |i: usize, j: usize| entries.get(i * dim + j).copied().unwrap_or_default();
    let unequal = (0..dim)
        .flat_map(|i| (0..i).map(move |j| (i, j)))
        .find(|&(i, j)| (entry(i, j) - entry(j, i)).abs() > 4.0 * f64::EPSILON * entry(i, j).abs());
    match unequal {
        None => Ok(Sym::from_fn(dim, entry)),
        Some((i, j)) => {
            let [above, below] =
                [(j, i), (i, j)].map(|(i, j)| format!("{:?} in row {}, column {}", entry(i, j), i + 1, j + 1));
            Err(Refusal::new(format!("{above} but {below}"), expected_tensor(dim)))
        }
    }
}
