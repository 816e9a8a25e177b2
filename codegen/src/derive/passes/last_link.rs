//! The last link in axes that point to its centre of mass.
//!
//! The axes of a link may be turned about its joint axis by any constant angle, which adds to the joint angle. For a link that carries no
//! other one nothing else changes: its body and the end effector are described in other axes. Turned by the angle phi of its first moment
//! (hx, hy), the body has
//!
//! ```text
//! hx' = sqrt(hx² + hy²),   hy' = 0
//! ```
//!
//! for the price of one addition, q + phi, before sine and cosine are taken.

use super::super::arm::Arm;
use super::super::parameters::View;
use super::super::plan::{Place, Plan};
use crate::exact::Rational;
use crate::manipulator::Manipulator;
use crate::pass::Pass;
use crate::ring::field::Field;
use crate::ring::matrix::Matrix;
use crate::ring::turn::Turn;
use crate::ring::{AngleSum, ExprId, Pool, Symbol};

/// The joint angle in quarter turns after the joint variable: 0 for sin(theta) = sin(q), 1 for sin(theta) = cos(q), and so on.
fn quarters(pool: &mut Pool, sine: ExprId, joint: u16) -> Option<usize> {
    let (s, c) = (pool.symbol(Symbol::Sine(joint)), pool.symbol(Symbol::Cosine(joint)));
    [s, c, -s, -c].iter().position(|&candidate| candidate == sine)
}

/// The last link of a chain, if it turns and carries none.
fn last(arm: &Arm) -> Option<usize> {
    let i = arm.tool.link;
    let alone = arm.joints[i].is_revolute() && arm.joints.iter().all(|joint| joint.parent != Some(i));
    alone.then_some(i)
}

/// The constant angle after the joint variable q at which the axes of the last link point to its centre of mass, seen along the joint axis.
/// None where a coordinate of the first moment is 0 or irrational.
pub(crate) fn angle_of_last_link(field: &Field, manipulator: &Manipulator) -> Option<Turn> {
    let mut pool = Pool::new(field.clone());
    let arm = Arm::new(&mut pool, manipulator, View::Nominal);
    let i = last(&arm)?;
    let moment = |k: usize| -> Option<Rational> {
        let value = pool.as_constant(arm.joints[i].body.first[k])?;
        value.as_rational().cloned()
    };
    let (x, y) = (moment(0)?, moment(1)?);
    if x.is_zero() || y.is_zero() {
        return None;
    }
    let (x, y) = match quarters(&mut pool, arm.joints[i].sine, i as u16)? {
        0 => (x, y),
        1 => (-y, x),
        2 => (-x, -y),
        _ => (y, -x),
    };
    Turn::towards(&x, &y)
}

/// Rotates the axes of the last link, or leaves them.
pub(super) fn rotate(pool: &mut Pool, arm: &mut Arm, plan: &mut Plan) {
    if pool.field().turn().is_some() && plan.way(Pass::LastLinkRotation, Place::Joint(arm.tool.link), 2) == 1 {
        rotate_last_link(pool, arm);
    }
}

/// Turns the axes of the last link by the angle of the field, if it has such an angle.
pub(crate) fn rotate_last_link(pool: &mut Pool, arm: &mut Arm) {
    let Some((turn, i)) = pool.field().turn().cloned().zip(last(arm)) else { return };
    let Some(quarters) = quarters(pool, arm.joints[i].sine, i as u16) else { return };
    let (s, c) = (pool.constant(&turn.sine), pool.constant(&turn.cosine));
    // From the axes of the description, quarter turns after q, to the new ones.
    let (s, c) = [(s, c), (-c, s), (-s, -c), (c, -s)][quarters];
    let back: Matrix = [[c, s, ExprId::ZERO], [-s, c, ExprId::ZERO], [ExprId::ZERO, ExprId::ZERO, ExprId::ONE]];
    let turned = AngleSum { turned: true, ..AngleSum::of(i as u16) };
    let joint = &mut arm.joints[i];
    (joint.sine, joint.cosine) = (pool.symbol(Symbol::SineOf(turned)), pool.symbol(Symbol::CosineOf(turned)));
    joint.body = joint.body.turned(pool, &back);
    joint.link_rotation = pool.product(&back, &joint.link_rotation);
    joint.link_origin = pool.transform(&back, &joint.link_origin);
    joint.own_axes = pool.product(&back, &joint.own_axes);
    joint.own_origin = pool.transform(&back, &joint.own_origin);
    for rotor in arm.rotors_on(i) {
        rotor.axis = pool.transform(&back, &rotor.axis);
    }
    for tool in arm.tools_of(i) {
        tool.rotation = pool.product(&back, &tool.rotation);
        tool.origin = pool.transform(&back, &tool.origin);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::derive::constants::field_of;
    use crate::derive::motion::Motion;
    use crate::derive::newton_euler::inverse_dynamics;
    use crate::exact::Number;
    use crate::source::Source;

    /// Two revolute joints; the second one's row and its link as given.
    fn arm_of(row: &str, link: &str) -> Manipulator {
        let text = format!(
            "name: arm\nconvention: standard\ngravity: [0, -9.81, 1]\njoints:\n  - {{name: j1, type: revolute, a: 1, alpha: pi/2, d: 0, \
             theta: 0, link: {{mass: 1, com: [0.1, 0.2, 0.3]}}}}\n  - {{name: j2, type: revolute, {row}, link: {{{link}}}}}\n"
        );
        crate::validate::read(&Source::new("robot.yaml", text)).0.expect("valid").0
    }

    const BODY: &str = "mass: 2, com: [-0.3, 0.4, 0.1], inertia: {xx: 1, yy: 2, zz: 2.5, xy: 0.1, xz: 0.2, yz: 0.3}";

    #[test]
    fn a_turned_arm_moves_alike_and_its_centre_of_mass_lies_on_the_axis() {
        for theta in ["0", "pi/2", "pi", "-pi/2"] {
            let manipulator = arm_of(&format!("a: 0.5, alpha: 0, d: 0.2, theta: {theta}"), BODY);
            let mut pool = Pool::new(field_of(&manipulator));
            let arm = Arm::new(&mut pool, &manipulator, View::Nominal);
            let mut turned = arm.clone();
            rotate_last_link(&mut pool, &mut turned);
            let [x, y, _] = turned.joints[1].body.first;
            // 2 kg at (0.2, 0.4) in the joint frame, whose origin lies 0.5 further in.
            assert_eq!((pool.as_constant(x), y), (Number::from(Rational::from_parts(4.into(), 5u8.into())).sqrt(), ExprId::ZERO));
            let motion = Motion::plain(&mut pool, &arm);
            let plain = inverse_dynamics(&mut pool, &arm, &motion);
            let other = inverse_dynamics(&mut pool, &turned, &motion);
            assert!(plain.iter().zip(&other).all(|(&a, &b)| pool.equal(a, b)), "theta: {theta}");
            let tips =
                [&arm, &turned].map(|arm| crate::derive::quantities::kinematics::direct_kinematics(&mut pool, arm).concat());
            assert!(tips[0].iter().zip(&tips[1]).all(|(&a, &b)| pool.equal(a, b)), "theta: {theta}");
        }
    }

    #[test]
    fn what_cannot_be_turned_is_left() {
        let turn = |row: &str, link: &str| {
            let manipulator = arm_of(row, link);
            field_of(&manipulator).turn().is_some()
        };
        let row = "a: 0, alpha: 0, d: 0.2, theta: 0";
        assert!(turn(row, BODY));
        assert!(!turn(row, "mass: 2, com: [0.3, 0, 0.1], inertia: {xx: 1, yy: 2, zz: 2.5}"), "it points there already");
        assert!(!turn("a: 0, alpha: 0, d: 0.2, theta: 0.3", BODY), "the joint angle has a general offset");
        assert!(!turn(row, "mass: 2, com: [0.3, sqrt(3), 0.1], inertia: {xx: 1, yy: 2, zz: 2.5}"), "coordinates with roots");
    }
}
