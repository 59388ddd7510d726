//! Nodes that follow others, as on the two sides of a sector of a cyclic body.

use super::frame::{self, NodeFrame};
use crate::mesh::{Link, Links, link_of};
use crate::tensor::{Point, dot};

/// The node and direction to prescribe for a direction prescribed at a node: at a follower, those of its leader.
pub fn given(links: &Links, node: u32, direction: Point, components: usize) -> (u32, Point) {
    match link_of(&links.nodes, node) {
        Some(link) => (link.to, if components > 1 { link.back(&direction) } else { direction }),
        None => (node, direction),
    }
}

/// The directions in which vectors on the axis vanish: two lists of nodes, each node with itself and a direction.
pub fn held_on_axis(links: &Links, components: usize) -> impl Iterator<Item = Vec<(u32, (u32, Point))>> + '_ {
    let lists = if components > 1 && !links.on_axis.is_empty() { 2 } else { 0 };
    (0..lists).map(|k| links.on_axis.iter().map(|&(node, across)| (node, (node, across[k]))).collect())
}

/// Adds frames of following nodes to those of the leaders, such that a vector has the same components at both.
pub fn add_frames(links: &[Link], components: usize, frames: &mut Vec<NodeFrame>) {
    if components == 1 {
        return;
    }
    let turned = |link: &Link| NodeFrame {
        node: link.node,
        axes: frame::directions(frames, link.to).map(|axis| link.turned(&axis)),
    };
    let more: Vec<NodeFrame> = links.iter().map(turned).collect();
    frames.extend(more);
    frames.sort_unstable_by_key(|frame| frame.node);
}

/// Copies the values of leaders to the nodes that follow them. `frames` are those in which their components are equal.
pub fn follow(links: &[Link], frames: &[NodeFrame], components: usize, values: &mut [f64]) {
    for link in links {
        let [own, followed] = [link.node, link.to].map(|node| node as usize * components);
        if frames.is_empty() {
            values.copy_within(followed..followed + components, own);
            continue;
        }
        let v: Point = std::array::from_fn(|c| if c < components { values[followed + c] } else { 0.0 });
        let [axes, turned] = [link.to, link.node].map(|node| frame::directions(frames, node));
        let along: Point = std::array::from_fn(|a| dot(&axes[a], &v));
        for c in 0..components {
            values[own + c] = (0..components).map(|a| turned[a][c] * along[a]).sum();
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::field::Field;
    use crate::mesh::{Diagonal, Link, Links, Mesh, MeshError};
    use crate::space::{Prescription, Space};

    /// A unit square whose right side follows the left side, turned by 30°.
    fn space(mesh: &Mesh) -> Space {
        let (s, c) = 30f64.to_radians().sin_cos();
        let turn = [[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]];
        let [left, right] = ["left", "right"].map(|side| mesh.facets[side].node_list());
        let nodes = left.iter().zip(&right).map(|(&to, &node)| Link { node, to, turn }).collect();
        let zero = Field::Constant(0.5);
        // Prescribed along y on top; at the last node this is a direction of the first one.
        let top = Prescription { on: "top", direction: [0.0, 1.0, 0.0], field: &zero };
        Space::linked(mesh, 2, [top], Links { nodes, on_axis: Vec::new() }, Vec::new())
    }

    /// Values at followers are turned, and forces at followers do the same work at their leaders: f·v is unchanged.
    #[test]
    fn forces_that_are_gathered_do_the_same_work() -> Result<(), MeshError> {
        let mesh = Mesh::rectangle([1.0, 1.0], [2, 2], Diagonal::Right)?;
        let space = space(&mesh);
        let mut v: Vec<f64> = (0..18).map(|i| f64::from(i * i % 7)).collect();
        space.follow(&mut v);
        for link in &space.links {
            let at = |node: u32| [v[2 * node as usize], v[2 * node as usize + 1], 0.0];
            let difference = link.back(&at(link.node));
            for c in 0..2 {
                assert!((difference[c] - at(link.to)[c]).abs() < 1e-14);
            }
        }
        let f: Vec<f64> = (0..18).map(|i| f64::from(i * 5 % 11)).collect();
        let work = |f: &[f64]| f.iter().zip(&v).map(|(f, v)| f * v).sum::<f64>();
        let mut gathered = f.clone();
        space.gather(&mut gathered);
        assert!((work(&f) - work(&gathered)).abs() < 1e-12);
        assert!(space.links.iter().all(|link| gathered[2 * link.node as usize..][..2] == [0.0, 0.0]));
        Ok(())
    }

    /// Both directions prescribed at a corner hold the leading node.
    #[test]
    fn what_is_prescribed_at_a_node_that_follows_is_prescribed_at_the_other() -> Result<(), MeshError> {
        let mesh = Mesh::rectangle([1.0, 1.0], [2, 2], Diagonal::Right)?;
        let space = space(&mesh);
        let corner = *space.links.iter().max_by_key(|link| link.node).expect("nodes that follow");
        assert!(space.is_held(corner.to) && space.is_held(corner.node));
        let mut values = vec![1.0; 18];
        space.prescribe(0.0, &mut values);
        for node in [corner.to, corner.node] {
            assert!((values[2 * node as usize + 1] - 0.5).abs() < 1e-14, "{values:?}");
        }
        Ok(())
    }
}
