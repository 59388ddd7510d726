//! The foundation in a step: its position and its motion.

use super::system::Step;
use crate::contact::obstacle::ObstacleLoad;
use crate::contact::{Contact, ContactBoundary, Obstacle, PointOnBoundary};
use crate::discretization::Discretization;
use crate::inclusion::{Drive, Frame, PointState};
use crate::problem::Problem;
use crate::state::Accumulated;
use crate::tensor::{self, Point, dot};
use crate::time::Interval;

/// The foundation at the contact points in the step from t_{n−1} to t_n of a body at `u`.
///
/// Without an obstacle ν is the normal of the body and g(x, t) the datum. An obstacle has the distance δ and the normal
/// n at the nearest point of its surface to x, or to x + u_{n−1} if it is followed: with ν = −n,
/// δ(x + u_n) ≈ δ(x + u_{n−1}) − ν·(u_n − u_{n−1}), so g = δ + ν·u_{n−1}. `worn` holds the depth worn off at each point
/// and the opening of the gap per depth worn off; `advance` holds δ of each contact at the start and at the end of the
/// step. They are empty if nothing wears or δ is zero. Rates are those of the rule of the step. In a steady step places
/// last and change no more, and the velocities of what slides last.
pub(crate) fn frames(
    problem: &Problem,
    boundary: &ContactBoundary,
    u: &[f64],
    (worn, advance): (&[[f64; 2]], [&[f64]; 2]),
    interval: Interval,
) -> Vec<Frame> {
    let (all, dim) = (&boundary.points, problem.mesh.dim);
    let mut frames = Vec::with_capacity(all.len());
    let Interval { start: from, end: to, level, before, .. } = interval;
    for (side, contact) in problem.contacts.iter().enumerate() {
        let first = frames.len();
        let points: &[PointOnBoundary] = all.get(first..).unwrap_or_default();
        let points = &points[..points.iter().take_while(|point| point.contact == side).count()];
        let x: Vec<Point> = points.iter().map(|point| point.x).collect();
        let gap_at = |t: f64| contact.gap.values(&x, t);
        let ([gap_from, gap], gap_before) = ([from, to].map(gap_at), before.map(gap_at));
        let velocity = velocities(contact, &x, level);
        // If the side `with` has the contact points, the slip is its own motion.
        let sign = contact.sign();
        let turns = contact.obstacle.as_ref().is_some_and(Obstacle::turns_in_place);
        let moving = if turns { interval.lasting() } else { interval };
        let moves = contact.obstacle.as_ref().map(|obstacle| obstacle.motion(to, &|of| moving.rate(of)));
        let [start, end] = advance.map(|all| all.get(side).copied().unwrap_or(0.0));
        for (i, point) in points.iter().enumerate() {
            let [depth, opening] = worn.get(first + i).copied().unwrap_or([0.0, 1.0]);
            let mut frame = Frame {
                normal: point.normal,
                gap: gap[i],
                gap_rate: interval.rate_of(gap_before.as_ref().map(|gap| gap[i]), [gap_from[i], gap[i]]),
                velocity: velocity.get(i).map_or([0.0; 3], |v| v.map(|v| sign * v)),
                slides: turns || velocity.get(i).is_some_and(|v| tensor::length(v) > 0.0),
                opening,
            };
            if contact.pair.as_ref().is_some_and(|pair| !pair.gap_is_given) {
                frame.gap += point.gap;
            }
            if let Some(obstacle) = &contact.obstacle {
                let u = if obstacle.updated { boundary.vector_at(point, dim, u) } else { [0.0; 3] };
                let at: Point = std::array::from_fn(|c| point.x[c] + u[c]);
                let nearest = |t: f64, by: f64| obstacle.nearest_moved(&at, t, by);
                let (first, now) = (nearest(from, start), nearest(to, end));
                let earlier = before.map(|t| nearest(t, start).distance);
                frame.normal = now.normal.map(|c| -c);
                frame.gap += now.distance + dot(&u, &frame.normal);
                frame.gap_rate += interval.rate_of(earlier, [first.distance, now.distance]);
                let along = obstacle.direction();
                let foot: Point = std::array::from_fn(|c| at[c] - now.distance * now.normal[c] - end * along[c]);
                let moves = moves.map_or([0.0; 3], |motion| motion.at(&foot));
                let advances = interval.rate_of(None, [start, end]);
                frame.velocity = std::array::from_fn(|c| frame.velocity[c] + moves[c] + advances * along[c]);
            } else {
                frame.gap += end;
                frame.gap_rate += interval.rate_of(None, [start, end]);
            }
            frame.gap += depth;
            let along = dot(&frame.velocity, &frame.normal);
            frame.velocity = std::array::from_fn(|c| frame.velocity[c] - along * frame.normal[c]);
            frames.push(frame);
        }
    }
    frames
}

/// The depth by which the gap is open at each contact point beyond the data, and the opening of the gap per depth worn
/// off; empty if nothing wears and no bilateral contact began with a phase. Open are the depth worn off, and the
/// distance at which such a contact began and that it keeps.
pub(crate) fn opened(
    discrete: &Discretization,
    contacts: &[Contact],
    boundary: &ContactBoundary,
    surface: &Accumulated,
) -> Vec<[f64; 2]> {
    let Accumulated { wear, worn, offset, .. } = surface;
    let mut all = discrete.worn.at_points(contacts, boundary, wear, &worn.depths);
    if all.is_empty() && !offset.is_empty() {
        all = vec![[0.0, 1.0]; boundary.points.len()];
    }
    all.iter_mut().zip(offset).for_each(|([depth, _], offset)| *depth += offset);
    all
}

/// v_F of the datum; empty for a foundation at rest.
fn velocities(contact: &Contact, x: &[Point], t: f64) -> Vec<Point> {
    let components: Vec<Vec<f64>> = contact.foundation_velocity.iter().map(|field| field.values(x, t)).collect();
    if components.is_empty() {
        return Vec::new();
    }
    (0..x.len()).map(|i| std::array::from_fn(|c| components.get(c).map_or(0.0, |values| values[i]))).collect()
}

impl Step<'_> {
    /// The contacts driven by a force in the step, with δ of each contact so far: tightened sections and obstacles
    /// under a load.
    pub(crate) fn drives(&self, advance: &[f64]) -> Vec<Drive> {
        let k = self.rule.k;
        let of = |(contact, of): (usize, &Contact)| {
            // A tool that does not act stays where it is.
            if !of.acts() {
                return None;
            }
            if let Some(force) = of.preload.as_ref().and_then(|preload| preload.force_in([self.old.t, self.t])) {
                return Some(Drive { contact, direction: None, force, inertia: [0.0; 2] });
            }
            let ObstacleLoad { force, direction, mass, .. } = of.obstacle.as_ref()?.load.as_ref()?;
            let at = |all: &[f64]| all.get(contact).copied().unwrap_or(0.0);
            let surface = &self.old.surface;
            let rate = (at(advance) - at(&surface.advance)) / k - at(&surface.advance_rate);
            let mass = self.rule.inertia(*mass);
            let inertia = [mass * rate / k, mass / (k * k)];
            Some(Drive { contact, direction: Some(*direction), force: force.value(&[0.0; 3], self.t), inertia })
        };
        self.problem.contacts.iter().enumerate().filter_map(of).collect()
    }

    /// Mean force per contact point of a driven contact, N.
    pub(crate) fn at_points(&self, drive: &Drive) -> f64 {
        let points = self.boundary.points.iter().filter(|point| point.contact == drive.contact).count();
        drive.force.abs() / points.max(1) as f64
    }

    /// What opens the gap at each contact point, as [`opened`] has it.
    pub(crate) fn worn(&self) -> Vec<[f64; 2]> {
        opened(self.discrete, self.contacts, self.boundary, &self.old.surface)
    }

    /// The moment of the forces on both bodies of each contact.
    pub(crate) fn moments(&self, states: &[PointState]) -> Vec<Point> {
        let lambda = states.iter().map(|s| std::array::from_fn(|c| s.pressure * s.normal[c] + s.q[c]));
        self.boundary.moments(&self.problem.contacts, &self.discrete.mesh, &self.old.u, lambda)
    }
}

/// θ_F(t_n) at the contact points where it is prescribed, K.
pub(crate) fn temperatures(step: &Step) -> Vec<f64> {
    let mut all = Vec::with_capacity(step.boundary.points.len());
    for (side, contact) in step.problem.contacts.iter().enumerate() {
        let points = step.boundary.points.iter().filter(|point| point.contact == side);
        let mut x: Vec<Point> = Vec::with_capacity(step.boundary.points.len());
        x.extend(points.map(|point| point.x));
        match step.inputs.foundations.get(&side) {
            Some(theta) => all.extend(x.iter().map(|_| *theta)),
            None => all.extend(contact.foundation_temperature.values(&x, step.level)),
        }
    }
    all
}

/// True for each contact point at rest against the foundation at a time `t`, at which a step of length `k` starts. A
/// bound that drops when slip starts is the static one there.
pub(crate) fn at_rest(
    problem: &Problem,
    boundary: &ContactBoundary,
    [u, w]: [&[f64]; 2],
    [t, k]: [f64; 2],
) -> Vec<bool> {
    // The velocity of an obstacle at t is computed by differences over the step. For a motion that starts from rest
    // they cancel except for round-off.
    let start = |obstacle: &Obstacle, x: &Point| -> [Point; 2] {
        let first = obstacle.motion(t, &|of| (4.0 * of(t + 0.5 * k) - 3.0 * of(t) - of(t + k)) / k);
        let mean = obstacle.motion(t, &|of| (of(t + k) - of(t)) / k);
        [first.at(x), mean.at(x)]
    };
    let frames = frames(problem, boundary, u, (&[], [&[]; 2]), Interval::at(t));
    let points = boundary.points.iter().zip(&frames);
    points
        .map(|(point, frame)| {
            let [obstacle, mean] = problem
                .contacts
                .get(point.contact)
                .and_then(|contact| contact.obstacle.as_ref())
                .map_or([[0.0; 3]; 2], |obstacle| start(obstacle, &point.x));
            let v = boundary.vector_at(point, problem.mesh.dim, w);
            let relative: Point = std::array::from_fn(|c| v[c] - frame.velocity[c] - obstacle[c]);
            let normal = dot(&relative, &frame.normal);
            let tangential: Point = std::array::from_fn(|c| relative[c] - normal * frame.normal[c]);
            tensor::length(&tangential)
                <= 1e-9 * [v, frame.velocity, mean].iter().map(tensor::length).fold(0.0, f64::max)
        })
        .collect()
}
