//! The constants of an arm in prime fields, and the claims of the text about its loop.

use std::cell::RefCell;

use armgen_description::exact::Polynomial;
use armgen_description::manipulator::{Body, Manipulator};

use super::chain::Chain;
use super::modular::{Frame, Modulus};
use super::text::{Arrangement, Given};
use crate::textbook::equations::arm::Arm;
use crate::values::arithmetic::plain::Plain;
use crate::values::arithmetic::prime::Prime;
use crate::values::arithmetic::roots::dependent;
use crate::values::arithmetic::Arithmetic;
use crate::values::formula::{Atoms, Dependent, Formula};
use crate::values::stream::Stream;

/// The description's numbers as formulas, with their roots and angles.
pub(super) struct Constants {
    pub(super) arm: Arm<Formula>,
    atoms: Atoms,
    dependent: Dependent,
}

impl Constants {
    /// The constants of an arm without bodies, together with `others`.
    pub(super) fn of(manipulator: &Manipulator, others: &[Formula]) -> Result<Constants, String> {
        let arm = Arm::nominal(&Plain, manipulator).and_then(|nominal| Arm::new(&Plain, manipulator, &nominal));
        let arm = arm.ok_or("the description divides by zero")?;
        let all = RefCell::new(others.to_vec());
        arm.map(&|number| {
            all.borrow_mut().push(number.clone());
            0.0
        });
        let atoms = Atoms::of(all.borrow().iter());
        let dependent = dependent(&atoms)?;
        Ok(Constants { arm, atoms, dependent })
    }

    /// Whether all constants are rational: no roots, angles or pi.
    pub(super) fn are_fractions(&self) -> bool {
        self.atoms.roots.is_empty() && self.atoms.angles.is_empty()
    }

    /// A field with a random prime.
    pub(super) fn field(&self, stream: &mut Stream) -> Result<Prime, String> {
        Prime::new(stream, &self.atoms, &self.dependent).ok_or_else(|| "there are too many independent roots".into())
    }
}

/// The chain of joints to the end effector without masses: no solution depends on bodies, whose formulas can be long.
pub(super) fn without_bodies(manipulator: &Manipulator) -> Manipulator {
    let mut arm = manipulator.chain();
    arm.payload = None;
    arm.tips.clear();
    for joint in &mut arm.joints {
        joint.link.truncate(1);
        for part in &mut joint.link {
            part.given = Body { mass: Polynomial::zero(), com: Default::default(), inertia: Default::default() };
            part.frame.elements.clear();
            part.axes.elements.clear();
        }
    }
    arm
}

/// A random posture: (c, s) or (d, 0).
pub(super) fn posture(chain: &Chain, field: &mut Prime) -> Vec<[u64; 2]> {
    let m = chain.modulus;
    let mut value = |slides: &bool| {
        if *slides {
            return [m.of(field.draw().value()), 0];
        }
        let (s, c) = field.draw_angle();
        [m.of(c.value()), m.of(s.value())]
    };
    chain.slides.iter().map(&mut value).collect()
}

/// The link that a given joint moves, from the claimed frames.
pub(super) fn link(given: &Given, numbers: &[Formula], field: &Prime, value: [u64; 2]) -> Option<Frame> {
    let m = Modulus::new(field.prime());
    let numbers: Option<Vec<u64>> = numbers.iter().map(|x| Some(m.of(field.constant(x)?.value()))).collect();
    let numbers = numbers?;
    let frame = |at: usize| -> Frame { std::array::from_fn(|i| std::array::from_fn(|j| numbers[at + 4 * i + j])) };
    let moved = m.joint(given.prismatic, [0, 0, m.one], value);
    Some(m.compose(&m.compose(&frame(0), &moved), &frame(12)))
}

/// The pose that the other joints have to reach if a joint at an end of the arm has this value.
pub(super) fn rest(given: &Given, link: &Frame, m: Modulus, pose: &Frame) -> Frame {
    let back = m.inverse_frame(link);
    if given.joint == 0 {
        m.compose(&back, pose)
    } else {
        m.compose(pose, &back)
    }
}

/// The image of a point under a displacement.
fn image(m: Modulus, f: &Frame, point: [u64; 3]) -> [u64; 3] {
    f.map(|row| m.plus(m.dot([row[0], row[1], row[2]], point), row[3]))
}

/// A loop with its exact numbers in a field.
#[derive(Clone)]
pub(super) struct Loop {
    pub(super) modulus: Modulus,
    pub(super) links: Vec<Frame>,
    pub(super) before: Frame,
    pub(super) after: Frame,
    pub(super) offsets: Vec<[u64; 2]>,
}

impl Loop {
    /// The loop with the exact numbers of its text, in order.
    pub(super) fn of(way: &Arrangement, numbers: &[Formula], field: &Prime) -> Option<Loop> {
        let modulus = Modulus::new(field.prime());
        let numbers: Option<Vec<u64>> = numbers.iter().map(|x| Some(modulus.of(field.constant(x)?.value()))).collect();
        let numbers = numbers?;
        let joints = way.order.len();
        let frame = |at: usize| -> Frame { std::array::from_fn(|i| std::array::from_fn(|j| numbers[at + 4 * i + j])) };
        let offset = |i: usize| [numbers[12 * joints + 24 + 2 * i], numbers[12 * joints + 24 + 2 * i + 1]];
        Some(Loop {
            modulus,
            links: (0..joints).map(|i| frame(12 * i)).collect(),
            before: frame(12 * joints),
            after: frame(12 * joints + 12),
            offsets: (0..joints).map(offset).collect(),
        })
    }

    /// Whether J1 L1 ... Jn Ln = 1 at a posture of the arm and its pose. Joints that the arm lacks are at 0.
    pub(super) fn closes(&self, way: &Arrangement, kinds: &[bool], posture: &[[u64; 2]], pose: &Frame) -> bool {
        self.values(way, kinds, posture).is_some_and(|values| self.is_met(&way.prismatic, &self.links_at(way, pose), &values))
    }

    /// The values of the loop's joints for a posture of the arm, with missing joints at 0; `None` if the joint types differ.
    pub(super) fn values(&self, way: &Arrangement, kinds: &[bool], posture: &[[u64; 2]]) -> Option<Vec<[u64; 2]>> {
        let m = self.modulus;
        let mut values = Vec::new();
        for (place, joint) in way.order.iter().enumerate() {
            let slides = way.prismatic[place];
            if kinds.get(*joint).is_some_and(|kind| *kind != slides) {
                return None;
            }
            let [c, s] = posture.get(*joint).copied().unwrap_or(if slides { [0, 0] } else { [m.one, 0] });
            let [a, b] = self.offsets[place];
            let value = if slides {
                [m.plus(c, a), 0]
            } else {
                [m.minus(m.times(c, a), m.times(s, b)), m.plus(m.times(s, a), m.times(c, b))]
            };
            values.push(value);
        }
        Some(values)
    }

    /// Whether the joint axes are linearly independent as screws at values that close the loop, so that the solution is isolated.
    pub(super) fn is_regular(&self, prismatic: &[bool], links: &[Frame], values: &[[u64; 2]]) -> bool {
        let m = self.modulus;
        let mut at = m.identity();
        let mut rows: Vec<[u64; 6]> = Vec::new();
        for ((slides, link), value) in prismatic.iter().zip(links).zip(values) {
            let (z, p) = (at.map(|row| row[2]), at.map(|row| row[3]));
            let (moment, turn) = if *slides { (z, [0; 3]) } else { (m.cross(p, z), z) };
            rows.push(std::array::from_fn(|i| if i < 3 { moment[i] } else { turn[i - 3] }));
            at = m.compose(&m.compose(&at, &m.joint(*slides, [0, 0, m.one], *value)), link);
        }
        let mut rank = 0;
        for entry in 0..6 {
            let Some(pivot) = (rank..rows.len()).find(|row| rows[*row][entry] != 0) else { continue };
            rows.swap(rank, pivot);
            let (over, pivot) = (m.inverse(rows[rank][entry]), rows[rank]);
            for row in rows.iter_mut().skip(rank + 1) {
                let factor = m.negated(m.times(row[entry], over));
                m.add_multiple(row, factor, &pivot);
            }
            rank += 1;
        }
        rank == prismatic.len()
    }

    /// The links for a pose.
    pub(super) fn links_at(&self, way: &Arrangement, pose: &Frame) -> Vec<Frame> {
        let m = self.modulus;
        let x = if way.backward { *pose } else { m.inverse_frame(pose) };
        let mut links = self.links.clone();
        links[way.open] = m.compose(&self.before, &m.compose(&x, &self.after));
        links
    }

    fn chain(&self, prismatic: &[bool], links: &[Frame], values: &[[u64; 2]]) -> Frame {
        let m = self.modulus;
        let joints = prismatic.iter().zip(links).zip(values);
        joints.fold(m.identity(), |product, ((slides, link), value)| {
            m.compose(&m.compose(&product, &m.joint(*slides, [0, 0, m.one], *value)), link)
        })
    }

    /// Whether J1 L1 ... Jn Ln = 1 for these joint values, with c² + s² = 1.
    pub(super) fn is_met(&self, prismatic: &[bool], links: &[Frame], values: &[[u64; 2]]) -> bool {
        self.are_values(prismatic, values) && self.chain(prismatic, links, values) == self.modulus.identity()
    }

    fn are_values(&self, prismatic: &[bool], values: &[[u64; 2]]) -> bool {
        let m = self.modulus;
        let on_circle = |[c, s]: &[u64; 2]| m.plus(m.times(*c, *c), m.times(*s, *s)) == m.one;
        prismatic.iter().zip(values).all(|(slides, value)| *slides || on_circle(value))
    }

    /// The image of a point moved by three joints: J1 L1 J2 L2 J3.
    pub(super) fn moved(&self, prismatic: &[bool], links: &[Frame], values: &[[u64; 2]], point: [u64; 3]) -> Option<[u64; 3]> {
        let m = self.modulus;
        let links = [links[0], links[1], m.identity()];
        let chain = self.chain(prismatic, &links, values);
        self.are_values(prismatic, values).then(|| image(m, &chain, point))
    }

    /// For a position that `tip` reaches: the point after the third joint, and its required place relative to the frame before the first.
    pub(super) fn points(&self, way: &Arrangement, pose: &Frame, tip: [u64; 3]) -> [[u64; 3]; 2] {
        let m = self.modulus;
        let position = pose.map(|row| row[3]);
        let back = m.inverse_frame(&self.after);
        if way.backward {
            [image(m, &self.before, position), image(m, &back, tip)]
        } else {
            [image(m, &self.before, tip), image(m, &back, position)]
        }
    }
}
