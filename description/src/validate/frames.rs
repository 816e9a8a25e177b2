//! Where joint frames lie: any frame will do whose z axis is the joint axis, but what the equations cost depends on it.
//!
//! Rows of Denavit and Hartenberg have joint frames of their own. In rows of the convention urdf frames stand anywhere, as somebody drew the
//! links; joint frames are then laid where Denavit and Hartenberg lay theirs, so that an arm costs the same whoever described it (the book,
//! Sect. 2.8.2). With the axes as lines at q = 0, u_i their directions, and line n + 1 the z axis of the end effector (of the link itself at
//! the end of another branch); where arms branch, i - 1 is the parent of i, and i + 1 its first child:
//!
//! ```text
//! x_i = ±u_i × u_{i+1} / |u_i × u_{i+1}|     skew lines: from line i to line i+1; intersecting ones: so that x_i · x_{i-1} ≥ 0
//! x_i = from line i to line i+1              parallel lines
//! x_i = x_{i-1}                              one line
//! origin: the foot of the common normal of lines i and i+1, on line i; where there is no one foot, or line i+1 is that of a slide, which
//!         may lie anywhere, the foot of the frame before
//! ```
//!
//! Where x_i would need another root than one of an integer, and where the foot is further away than the arm is long (nearly parallel
//! lines), the frame stays with the link: values are the same, the equations have more terms. So does the origin where the link lies next to its
//! parent's axis, or the next link next to its own, but not on it: a short lever arm would be the sum of two longer ones, and lose its digits.

use std::cmp::Ordering;

use super::geometry::{cross, dot};
use crate::exact::{Number, Polynomial};
use crate::kinds::JointKind;
use crate::manipulator::{Joint, Parameter, Placement, Pose};

/// Terms of a number of a joint frame.
const MAX_TERMS: usize = 16;

/// Moves each placement into the joint frame of its parent. `ends`: links of end effectors, with their tools. `anywhere`: rows say nothing of joint frames, which are laid first.
pub(super) fn lay(joints: &mut [Joint], ends: &[(usize, &Pose)], anywhere: bool, parameters: &[Parameter]) {
    let mut frames: Vec<Placement> = Vec::new();
    let reach = 2.0
        * joints
            .iter()
            .map(|joint| &joint.row.before.frame)
            .chain(ends.iter().map(|(_, tool)| &tool.frame))
            .map(|f| size(f, parameters))
            .sum::<f64>();
    let bare = Pose::identity();
    for i in 0..joints.len() {
        let frame = match anywhere {
            true => {
                let before = joints[i].parent.map(|parent| &frames[parent.index()]);
                let next = joints[i + 1..].iter().find(|joint| joint.parent.is_some_and(|parent| parent.index() == i));
                let end = ends.iter().find(|(link, _)| *link == i).map_or(&bare, |(_, tool)| tool);
                let turns = joints[i].parent.is_some_and(|parent| joints[parent.index()].kind == JointKind::Revolute);
                frame(&joints[i], before, next, end, (reach, turns, joints.len()), parameters)
            }
            false => Placement::identity(),
        };
        frames.push(frame);
    }
    for i in 0..joints.len() {
        let row = &joints[i].row;
        let after = row.after.frame.clone();
        let placement = match joints[i].parent {
            Some(parent) => joints[parent.index()].link_frame.then(&row.before.frame),
            None => row.before.frame.clone(),
        };
        if anywhere {
            joints[i].placement = placement.then(&frames[i]);
            joints[i].link_frame = frames[i].inverse().then(&after);
        } else {
            joints[i].placement = placement;
        }
    }
}

/// |xyz| at the nominal values of all names.
fn size(frame: &Placement, parameters: &[Parameter]) -> f64 {
    length(frame.translation.each_ref().map(|x| value(x, parameters)))
}

fn length(vector: [f64; 3]) -> f64 {
    vector.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn value(polynomial: &Polynomial, parameters: &[Parameter]) -> f64 {
    polynomial.evaluate(&|id| parameters[id.0 as usize].nominal.clone()).to_f64()
}

/// Whether a distance is lost beside a longer lever arm, in a sum with it: exporters write 1e-6 m for 0.
///
/// Of n joints text may lose a factor of 2^(4 + n), by the checker's rule of rounding. A distance of exactly 0 leaves no term behind.
fn is_lost(distance: f64, lever: f64, joints: usize) -> bool {
    distance > 0.0 && lever > (4.0 + joints as f64).exp2() * distance
}

/// A joint frame in the frame in which the row has its axis. `before`: that of the parent, likewise; `next`: its first child; `end`: the frame at
/// the end of the chain, if it carries none. `joints`: how many the arm has.
fn frame(
    joint: &Joint,
    before: Option<&Placement>,
    next: Option<&Joint>,
    end: &Pose,
    (reach, parent_turns, joints): (f64, bool, usize),
    parameters: &[Parameter],
) -> Placement {
    let u = &joint.row.axis;
    let onward = next.map_or(&end.frame, |joint| &joint.row.before.frame);
    let e_z = [Number::zero(), Number::zero(), Number::one()];
    let v = onward.direction(next.map_or(&e_z, |joint| &joint.row.axis));
    let p = &onward.translation;
    // The parent's joint frame in this frame.
    let before = before.map(|frame| joint.row.before.frame.inverse().then(frame));
    let x_before = before.as_ref().map(|frame| column(frame, 0));

    let n = cross(u, &v);
    let parallel = n.iter().all(is_zero);
    let aside = perpendicular(u, p);
    let slides = next.is_some_and(|joint| joint.kind == JointKind::Prismatic);
    let own = if next.is_none() { Some(column(onward, 0)) } else { None };
    let x = if let Some(own) = own.filter(|x| is_zero(&dot(x, u))) {
        Some(own)
    } else if !parallel {
        let meet = !slides && is_zero_polynomial(&dot_polynomial(p, &n));
        unit(&n).map(|x| {
            let against = match &x_before {
                Some(other) if meet => dot(&x, other).sign() == Ordering::Less,
                _ => !meet && !slides && value(&dot_polynomial(p, &x), parameters) < 0.0,
            };
            if against {
                x.map(|e| -&e)
            } else {
                x
            }
        })
    } else {
        let numbers: Option<Vec<Number>> = aside.iter().map(Polynomial::as_number).collect();
        let numbers: Option<[Number; 3]> = numbers.and_then(|n| n.try_into().ok());
        let apart = numbers.filter(|a| !slides && !a.iter().all(is_zero)).and_then(|a| unit(&a));
        apart.or_else(|| x_before.clone().filter(|x| is_zero(&dot(x, u))))
    };
    let x = x.filter(is_short).unwrap_or_else(|| any_perpendicular(u));

    // The coordinate of the origin along the axis.
    let of_before = before.as_ref().map_or_else(Polynomial::zero, |frame| dot_polynomial(&frame.translation, u));
    let along = if next.is_none() && parallel {
        dot_polynomial(p, u)
    } else if parallel || slides {
        of_before.clone()
    } else {
        foot(p, &v, &n).unwrap_or_else(|| of_before.clone())
    };
    // How far the next link lies from this axis.
    let onward_distance = match joint.kind {
        JointKind::Revolute => length(cross_polynomial(p, u).each_ref().map(|x| value(x, parameters))),
        JointKind::Prismatic => 0.0,
    };
    // How far 0 lies from the parent's axis, and a point of this axis for each metre of its own.
    let (distance, slope) = before.as_ref().filter(|_| parent_turns).map_or((0.0, 0.0), |frame| {
        let z = column(frame, 2);
        let lever = cross_polynomial(&frame.translation, &z).each_ref().map(|x| value(x, parameters));
        (length(lever), length(cross(&z, u).each_ref().map(Number::to_f64)))
    });
    let fits = |s: &Polynomial| {
        let size = value(s, parameters).abs();
        let lost = is_lost(distance, size * slope, joints) || is_lost(onward_distance, size, joints);
        size <= reach && !lost && s.terms().all(|(_, c)| c.terms().count() <= MAX_TERMS)
    };
    let along = [along, of_before].into_iter().find(fits).unwrap_or_default();
    let laid = about_axis(u, &x, &along);
    if laid.is_multiplied_out() && laid.inverse().is_multiplied_out() {
        laid
    } else {
        about_axis(u, &any_perpendicular(u), &Polynomial::zero())
    }
}

/// The frame with its z axis along u, its x axis along x and its origin at u `along`.
fn about_axis(u: &[Number; 3], x: &[Number; 3], along: &Polynomial) -> Placement {
    let y = cross(u, x);
    Placement {
        rotation: std::array::from_fn(|k| [x[k].clone(), y[k].clone(), u[k].clone()]),
        translation: std::array::from_fn(|k| along * &Polynomial::from(u[k].clone())),
    }
}

fn column(frame: &Placement, k: usize) -> [Number; 3] {
    std::array::from_fn(|i| frame.rotation[i][k].clone())
}

/// A zero, even one that no reduction sees.
fn is_zero(number: &Number) -> bool {
    number.sign() == Ordering::Equal
}

fn is_zero_polynomial(polynomial: &Polynomial) -> bool {
    polynomial.terms().all(|(_, c)| is_zero(c))
}

fn is_short(direction: &[Number; 3]) -> bool {
    direction.iter().all(|x| x.terms().count() <= MAX_TERMS && !x.is_shared())
}

fn dot_polynomial(a: &[Polynomial; 3], b: &[Number; 3]) -> Polynomial {
    (0..3).fold(Polynomial::zero(), |sum, k| &sum + &(&a[k] * &Polynomial::from(b[k].clone())))
}

/// p less its part along u.
fn perpendicular(u: &[Number; 3], p: &[Polynomial; 3]) -> [Polynomial; 3] {
    let along = dot_polynomial(p, u);
    std::array::from_fn(|k| &p[k] - &(&along * &Polynomial::from(u[k].clone())))
}

/// The unit vector along a vector other than 0, if it needs no other root than one of an integer.
fn unit(vector: &[Number; 3]) -> Option<[Number; 3]> {
    let given: Vec<usize> = (0..3).filter(|&k| !is_zero(&vector[k])).collect();
    if let [only] = given[..] {
        let one = if vector[only].is_negative() { Number::from(-1) } else { Number::one() };
        return Some(std::array::from_fn(|k| if k == only { one.clone() } else { Number::zero() }));
    }
    let square = dot(vector, vector);
    square.as_rational()?;
    let length = square.sqrt()?;
    let unit = [0, 1, 2].map(|k| vector[k].checked_div(&length));
    let [x, y, z] = unit;
    Some([x?, y?, z?])
}

/// A unit vector perpendicular to u, without a further root: the next axis where u is one; else of the rotation that takes z to u.
fn any_perpendicular(u: &[Number; 3]) -> [Number; 3] {
    let e = |only: usize| std::array::from_fn(|k| if k == only { Number::one() } else { Number::zero() });
    if let Some(axis) = (0..3).find(|&k| (0..3).all(|j| j == k || is_zero(&u[j]))) {
        return e((axis + 1) % 3);
    }
    // The x axis, mirrored in the plane that takes z to ±u: e_x - u_x (e_z ± u) / (1 ± u_z).
    let sign = if u[2].is_negative() { Number::from(-1) } else { Number::one() };
    let z = &u[2] * &sign;
    let factor = u[0].checked_div(&(&Number::one() + &z)).expect("1 + |u_z| is not 0");
    [&Number::one() - &(&factor * &u[0]), -&(&factor * &u[1]), -&(&u[0] * &sign)]
}

/// p × v
fn cross_polynomial(p: &[Polynomial; 3], v: &[Number; 3]) -> [Polynomial; 3] {
    std::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        &(&p[j] * &Polynomial::from(v[k].clone())) - &(&p[k] * &Polynomial::from(v[j].clone()))
    })
}

/// The foot, on the line through 0 along u, of its common normal with the line through p along v, where n = u × v: (p × v)·n / n·n.
fn foot(p: &[Polynomial; 3], v: &[Number; 3], n: &[Number; 3]) -> Option<Polynomial> {
    let lever = cross_polynomial(p, v);
    let given: Vec<usize> = (0..3).filter(|&k| !is_zero(&n[k])).collect();
    let (above, below) = match given[..] {
        [only] => (lever[only].clone(), n[only].clone()),
        _ => (dot_polynomial(&lever, n), dot(n, n)),
    };
    let inverse = below.simple_inverse()?;
    Some(&above * &Polynomial::from(inverse))
}
