//! Bounds of Taylor coefficients of the torques along a piece, by majorants.
//!
//! Entry k of a [`Sequence`] bounds the length (or the norm) of the k-th Taylor coefficient in s of a vector (or a matrix), at any place
//! of the piece. Sums and products of vectors have sums and convolutions of sequences. A unit vector fixed in a link turns with the
//! link's rate w: its sequence beta follows from (k + 1) beta_{k+1} = sum_l w_l beta_{k-l}, beta_0 = 1. All else is Newton and Euler:
//!
//! ```text
//! w_i = w_p + beta_p |q'_i|                                    revolute; p carries joint i
//! r_i = (distance_i + |q_i|) beta_p                            |q_i| for a slide alone
//! V_i = V_p + r_i',   P = m V_i + (h_i beta_i)',   L = J_i beta_i beta_i w_i + h_i beta_i V_i
//! inertial:  force P,  moment L;      velocity:  force P',  moment L' + V_i P;      gravity:  force m g0,  moment h_i beta_i g0
//! end effector:  |V_i + (distance beta_i)'|², |w_i|²
//! back:  f_p += f_i,  N_p += N_i + r_i f_i;     torque_i = beta_p N_i, of a slide beta_p f_i, and the rotor's
//! ```

use super::limits::ToolLimit;
use super::model::LinkBound;
use super::path::Piece;
use super::polynomial::{self, ORDER};
use crate::linalg::lit;
use nalgebra::RealField;

/// Orders 0 to 11: positions need two derivatives more than torques.
const ORDERS: usize = 12;
/// The order of the remainder of an interpolant through nine nodes.
pub(super) const NINE: usize = 9;

type Sequence<T> = [T; ORDERS];

/// Bounds of the torques of a piece at one order.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds<T, const N: usize> {
    pub inertial: [T; N],
    pub velocity: [T; N],
    pub gravity: [T; N],
    /// Squares of the end effector's speed and turn rate.
    pub tool: [T; 2],
}

fn plus<T: RealField + Copy>(a: &Sequence<T>, b: &Sequence<T>) -> Sequence<T> {
    let mut sum = *a;
    for (a, b) in sum.iter_mut().zip(b) {
        *a += *b;
    }
    sum
}

fn times<T: RealField + Copy>(a: &Sequence<T>, b: &Sequence<T>) -> Sequence<T> {
    let mut product = [T::zero(); ORDERS];
    for (i, a) in a.iter().enumerate() {
        for (to, b) in product.iter_mut().skip(i).zip(b) {
            *to += *a * *b;
        }
    }
    product
}

fn scaled<T: RealField + Copy>(a: &Sequence<T>, by: T) -> Sequence<T> {
    a.map(|a| a * by)
}

/// The derivative; its last order is lost, and no result depends on it.
fn derivative<T: RealField + Copy>(a: &Sequence<T>) -> Sequence<T> {
    let mut of = [T::zero(); ORDERS];
    for (k, (to, from)) in of.iter_mut().zip(a.iter().skip(1)).enumerate() {
        *to = *from * lit((k + 1) as f64);
    }
    of
}

/// beta of a link that turns with w.
fn turning<T: RealField + Copy>(w: &Sequence<T>) -> Sequence<T> {
    let mut beta = [T::zero(); ORDERS];
    beta[0] = T::one();
    for k in 0..ORDERS - 1 {
        let sum = (0..=k).fold(T::zero(), |sum, l| sum + w[l] * beta[k - l]);
        beta[k + 1] = sum / lit((k + 1) as f64);
    }
    beta
}

#[derive(Clone, Copy)]
struct Link<T> {
    beta: Sequence<T>,
    w: Sequence<T>,
    velocity: Sequence<T>,
    /// Of the joint's origin from that of the joint that carries it.
    from_parent: Sequence<T>,
    /// |q'|.
    rate: Sequence<T>,
    /// Forces and moments of inertial, velocity, gravity.
    force: [Sequence<T>; 3],
    moment: [Sequence<T>; 3],
    /// Of the joint's own rotor.
    rotor: [Sequence<T>; 2],
}

/// Bounds of the torques at order 0, their size, and at order 9, for the whole piece.
pub(super) fn bounds<T: RealField + Copy, const N: usize>(
    links: &[LinkBound<T>; N],
    gravity: T,
    tool: Option<&ToolLimit<T>>,
    piece: &Piece<T, N>,
) -> [Bounds<T, N>; 2] {
    let zero = [T::zero(); ORDERS];
    let mut still = zero;
    still[0] = T::one();
    let base = Link {
        beta: still,
        w: zero,
        velocity: zero,
        from_parent: zero,
        rate: zero,
        force: [zero; 3],
        moment: [zero; 3],
        rotor: [zero; 2],
    };
    let mut all = [base; N];
    for (i, of) in links.iter().enumerate() {
        let parent = of.parent.and_then(|p| all.get(p)).copied().unwrap_or(base);
        // |q| and |q'|, order by order.
        let mut q = zero;
        let mut polynomial = piece.joint(i);
        let mut factorial = T::one();
        for k in 0..ORDER {
            q[k] = polynomial::largest(&polynomial, piece.length) / factorial;
            polynomial = polynomial::derivative(&polynomial);
            factorial *= lit((k + 1) as f64);
        }
        let rate = derivative(&q);
        let mut reach = scaled(&still, of.distance);
        let mut w = parent.w;
        if of.slides {
            reach = plus(&reach, &q);
        } else {
            w = plus(&w, &times(&parent.beta, &rate));
        }
        let beta = turning(&w);
        let from_parent = times(&reach, &parent.beta);
        let velocity = plus(&parent.velocity, &derivative(&from_parent));
        let arm = scaled(&beta, of.first_moment);
        let momentum = plus(&scaled(&velocity, of.mass), &derivative(&arm));
        let spin = plus(&times(&times(&scaled(&beta, of.inertia), &beta), &w), &times(&arm, &velocity));
        // A rotor spins about an axis fixed in the link that carries it.
        let along = plus(&scaled(&rate, of.reflected), &scaled(&times(&parent.beta, &parent.w), of.coupling));
        let link = Link {
            beta,
            w,
            velocity,
            from_parent,
            rate,
            force: [momentum, derivative(&momentum), scaled(&still, of.mass * gravity)],
            moment: [spin, plus(&derivative(&spin), &times(&velocity, &momentum)), scaled(&arm, gravity)],
            rotor: [along, derivative(&along)],
        };
        if let Some(place) = all.get_mut(i) {
            *place = link;
        }
    }
    // The momentum of each rotor acts on the link that carries it.
    for i in 0..N {
        let rate = all[i].rate;
        if let Some(parent) = links[i].parent.and_then(|p| all.get_mut(p)) {
            let momentum = scaled(&times(&parent.beta, &rate), links[i].coupling);
            parent.moment[0] = plus(&parent.moment[0], &momentum);
            parent.moment[1] = plus(&parent.moment[1], &derivative(&momentum));
        }
    }
    let empty = Bounds { inertial: [T::zero(); N], velocity: [T::zero(); N], gravity: [T::zero(); N], tool: [T::zero(); 2] };
    let mut bounds = [empty; 2];
    if let Some((tool, link)) = tool.and_then(|tool| Some((tool, all.get(tool.joint).or(all.last())?))) {
        let velocity = plus(&link.velocity, &derivative(&scaled(&link.beta, tool.distance)));
        let [speed, turn_rate] = [velocity, link.w].map(|of| times(&of, &of));
        let [size, ninth] = &mut bounds;
        (size.tool, ninth.tool) = ([speed[0], turn_rate[0]], [speed[NINE], turn_rate[NINE]]);
    }
    for i in (0..N).rev() {
        let link = all[i];
        let parent_beta = links[i].parent.and_then(|p| all.get(p)).map_or(still, |p| p.beta);
        for part in 0..3 {
            let mut torque = times(&parent_beta, if links[i].slides { &link.force[part] } else { &link.moment[part] });
            if let Some(rotor) = link.rotor.get(part) {
                torque = plus(&torque, rotor);
            }
            for (of, order) in bounds.iter_mut().zip([0, NINE]) {
                let place = [&mut of.inertial, &mut of.velocity, &mut of.gravity];
                if let Some(place) = place.into_iter().nth(part) {
                    place[i] = torque[order];
                }
            }
        }
        if let Some(parent) = links[i].parent.and_then(|p| all.get_mut(p)) {
            for part in 0..3 {
                parent.force[part] = plus(&parent.force[part], &link.force[part]);
                let carried = plus(&link.moment[part], &times(&link.from_parent, &link.force[part]));
                parent.moment[part] = plus(&parent.moment[part], &carried);
            }
        }
    }
    bounds
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two links in a plane, rates a and b: |p'|² = (l_1 a)² + (l_2 (a + b))² + 2 l_1 l_2 a (a + b) cos(q_2).
    #[test]
    fn the_speed_of_the_end_effector_is_bounded() {
        let link = |parent: Option<usize>, distance: f64| LinkBound {
            parent,
            slides: false,
            distance,
            mass: 0.0,
            first_moment: 0.0,
            inertia: 0.0,
            coupling: 0.0,
            reflected: 0.0,
        };
        let ([l1, l2], [a, b]) = ([0.7, 0.4], [1.5, 2.5]);
        let tool = ToolLimit { speed: 1.0, turn_rate: 1.0, joint: 1, distance: l2 };
        let links = [link(None, 0.3), link(Some(0), l1)];
        let [size, ninth] = bounds(&links, 0.0, Some(&tool), &Piece::line(0.0, 1.0, [0.2, -1.0], [0.2 + a, b - 1.0]));
        let factorial: f64 = (1..=9).map(f64::from).product();
        let (most, of_cosine) = ((l1 * a + l2 * (a + b)).powi(2), 2.0 * l1 * l2 * a * (a + b) * b.powi(9) / factorial);
        let near = |bound: f64, value: f64| bound >= value * (1.0 - 1e-12) && bound <= value * (1.0 + 1e-12);
        assert!(near(size.tool[0], most) && near(size.tool[1], (a + b).powi(2)), "{size:?} {most}");
        assert!(ninth.tool[0] >= of_cosine && ninth.tool[1] >= 0.0, "{ninth:?} {of_cosine}");
    }
}
