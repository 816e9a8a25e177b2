//! Soundness of every branch: the unmodified building blocks run in prime fields.
//!
//! The blocks of closed forms consist of arithmetic, square roots, and comparisons with tolerances. In a prime field nothing is rounded:
//! tolerances are 0, every nonzero element counts as positive, and half of all elements have a square root. Results from a missing square root
//! are not numbers. At random reachable poses, every branch that the construction returns must close the loop exactly, with c² + s² = 1 in every
//! joint. Poses are drawn until each branch has done so. A wrong branch passes at a random pose with odds of about its degree over the prime:
//! less than 1e-15.
//!
//! Signs of square roots have no meaning in a field, so this check does not verify the names of branches.

use std::cell::Cell;

use super::modular::{Frame as Displacement, Modulus};
use super::points::Loop;
use super::text::{Construction, Text};

thread_local! {
    static FIELD: Cell<Option<Field>> = const { Cell::new(None) };
    /// Whether a missing value has been compared, so that some branches of a run may be arbitrary.
    static UNKNOWN: Cell<bool> = const { Cell::new(false) };
}

/// A prime field with constants for square roots.
#[derive(Clone, Copy, Debug)]
struct Field {
    m: Modulus,
    /// p - 1 = 2^twos odd.
    twos: u32,
    odd: u64,
    /// An element of order 2^twos.
    generator: u64,
}

impl Field {
    fn new(m: Modulus) -> Field {
        let (twos, half) = ((m.prime - 1).trailing_zeros(), (m.prime - 1) / 2);
        let odd = (m.prime - 1) >> twos;
        let mut candidate = 2;
        let minus = m.negated(m.one);
        while m.power(m.integer(candidate), half) != minus {
            candidate += 1;
        }
        Field { m, twos, odd, generator: m.power(m.integer(candidate), odd) }
    }

    /// The square root with the smaller representative, if it exists (Tonelli and Shanks).
    fn sqrt(self, x: u64) -> Option<u64> {
        let m = self.m;
        if x == 0 {
            return Some(0);
        }
        let mut root = m.power(x, self.odd.div_ceil(2));
        let mut rest = m.power(x, self.odd);
        let (mut generator, mut order) = (self.generator, self.twos);
        while rest != m.one {
            let mut twos = 0;
            let mut square = rest;
            while square != m.one {
                square = m.times(square, square);
                twos += 1;
                if twos == order {
                    return None;
                }
            }
            for _ in 0..order - twos - 1 {
                generator = m.times(generator, generator);
            }
            root = m.times(root, generator);
            generator = m.times(generator, generator);
            rest = m.times(rest, generator);
            order = twos;
        }
        let other = m.negated(root);
        Some(if m.value(root) <= m.value(other) { root } else { other })
    }
}

/// The blocks over a prime field: the texts of `armgen-inverse-kinematics`, and here the scalar operations that they need.
#[allow(dead_code, unreachable_pub, missing_docs, clippy::all, clippy::pedantic)]
mod blocks {
    /// An element of the field, or a missing value after a nonexistent square root or a division by 0.
    #[derive(Clone, Copy, Debug)]
    pub enum Real {
        /// A number of the text.
        Number(f64),
        Element(Option<u64>),
    }

    fn field() -> super::Field {
        super::FIELD.get().expect("a field is set before blocks run")
    }

    impl Real {
        pub const ZERO: Real = Real::Element(Some(0));
        pub const NAN: Real = Real::Element(None);
        /// Misses are ignored.
        pub const INFINITY: Real = Real::ZERO;

        /// A number in a text: a small multiple of 1/1024.
        pub const fn of(x: f64) -> Real {
            Real::Number(x)
        }

        pub fn value(self) -> Option<u64> {
            match self {
                Real::Element(x) => x,
                Real::Number(x) if x == 0.0 => Some(0),
                Real::Number(x) if x == 1.0 => Some(field().m.one),
                Real::Number(x) if x == x.trunc() => Some(field().m.integer(x as i64)),
                Real::Number(x) => {
                    let m = field().m;
                    Some(m.times(m.integer((x * 1024.0) as i64), m.inverse(m.integer(1024))))
                }
            }
        }

        pub fn abs(self) -> Real {
            self
        }

        pub fn max(self, _: Real) -> Real {
            self
        }

        pub fn min(self, _: Real) -> Real {
            self
        }

        fn with(self, other: Real, operation: impl FnOnce(super::Modulus, u64, u64) -> Option<u64>) -> Real {
            Real::Element(self.value().zip(other.value()).and_then(|(x, y)| operation(field().m, x, y)))
        }
    }

    macro_rules! operator {
        ($name:ident, $function:ident, $operation:expr) => {
            impl std::ops::$name for Real {
                type Output = Real;
                fn $function(self, other: Real) -> Real {
                    self.with(other, $operation)
                }
            }
            impl std::ops::$name<&Real> for Real {
                type Output = Real;
                fn $function(self, other: &Real) -> Real {
                    self.with(*other, $operation)
                }
            }
            impl std::ops::$name<Real> for &Real {
                type Output = Real;
                fn $function(self, other: Real) -> Real {
                    self.with(other, $operation)
                }
            }
            impl std::ops::$name<&Real> for &Real {
                type Output = Real;
                fn $function(self, other: &Real) -> Real {
                    self.with(*other, $operation)
                }
            }
        };
    }

    operator!(Add, add, |m, x, y| Some(m.plus(x, y)));
    operator!(Sub, sub, |m, x, y| Some(m.minus(x, y)));
    operator!(Mul, mul, |m, x, y| Some(m.times(x, y)));
    operator!(Div, div, |m, x, y| (y != 0).then(|| m.times(x, m.inverse(y))));

    impl std::ops::Neg for Real {
        type Output = Real;
        fn neg(self) -> Real {
            Real::ZERO - self
        }
    }

    impl std::ops::Neg for &Real {
        type Output = Real;
        fn neg(self) -> Real {
            Real::ZERO - self
        }
    }

    impl std::ops::AddAssign for Real {
        fn add_assign(&mut self, other: Real) {
            *self = *self + other;
        }
    }

    impl std::ops::SubAssign for Real {
        fn sub_assign(&mut self, other: Real) {
            *self = *self - other;
        }
    }

    impl std::ops::MulAssign for Real {
        fn mul_assign(&mut self, other: Real) {
            *self = *self * other;
        }
    }

    impl PartialEq for Real {
        fn eq(&self, other: &Real) -> bool {
            self.value().is_some() && self.value() == other.value()
        }
    }

    /// Distinct elements compare as larger, so a nonzero difference never counts as rounding error.
    impl PartialOrd for Real {
        fn partial_cmp(&self, other: &Real) -> Option<std::cmp::Ordering> {
            let values = self.value().zip(other.value());
            super::UNKNOWN.set(super::UNKNOWN.get() || values.is_none());
            let (x, y) = values?;
            Some(if x == y { std::cmp::Ordering::Equal } else { std::cmp::Ordering::Greater })
        }
    }

    pub const UNIT_ROUNDOFF: Real = Real::ZERO;

    pub fn sqrt(x: Real) -> Real {
        Real::Element(x.value().and_then(|x| field().sqrt(x)))
    }

    /// The tangent of half the angle represents an angle.
    pub fn atan2(s: Real, c: Real) -> Real {
        s / (sqrt(c * c + s * s) + c)
    }

    pub fn cos_sin(half: Real) -> (Real, Real) {
        let one = Real::of(1.0);
        let over = one / (one + half * half);
        ((one - half * half) * over, (half + half) * over)
    }

    /// Roots of an equation on the circle have no closed form, so this list stays empty.
    pub struct CircleRoots<const N: usize> {
        pub count: usize,
        pub all: [CircleRoot; N],
        pub near: bool,
        pub free: bool,
    }

    #[derive(Clone, Copy)]
    pub struct CircleRoot {
        pub c: Real,
        pub s: Real,
        pub double: bool,
        pub error: Real,
    }

    fn circle_roots<const D: usize, const N: usize>(
        _: &[Real; D],
        _: &[Real; D],
        _: Real,
        _: Real,
        _: impl FnMut(&[[Real; 2]; 9]) -> [Real; 9],
    ) -> CircleRoots<N> {
        let none = CircleRoot { c: Real::ZERO, s: Real::ZERO, double: false, error: Real::ZERO };
        CircleRoots { count: 0, all: [none; N], near: false, free: false }
    }

    include!(concat!(env!("OUT_DIR"), "/blocks.rs"));
}

use blocks::Real;

fn real(x: u64) -> Real {
    Real::Element(Some(x))
}

fn frame(f: &Displacement) -> blocks::Frame {
    f.map(|row| row.map(real))
}

/// A pose for running a construction.
pub(super) struct At<'a> {
    pub(super) closed: &'a Loop,
    /// The pose that the joints of the loop have to reach.
    pub(super) pose: &'a Displacement,
    /// For a position: the point at the position, relative to the frame after these joints.
    pub(super) tip: [u64; 3],
    /// The posture that reaches the pose, in the arm's order.
    pub(super) posture: &'a [[u64; 2]],
}

type Case = fn(&blocks::Frame, &blocks::Frame, blocks::Vector, blocks::Vector) -> blocks::Branches<3, 4>;

fn case(name: &str) -> Option<Case> {
    Some(match name {
        "regional_elbow" => blocks::regional_elbow,
        "regional_crossing" => blocks::regional_crossing,
        "regional_slide_elbow" => blocks::regional_slide_elbow,
        "regional_slide_across" => blocks::regional_slide_across,
        "regional_mid_slide_elbow" => blocks::regional_mid_slide_elbow,
        "regional_mid_slide_across" => blocks::regional_mid_slide_across,
        "regional_plane_then_turn" => blocks::regional_plane_then_turn,
        "regional_slide_turn_slide" => blocks::regional_slide_turn_slide,
        "regional_slides" => blocks::regional_slides,
        _ => return None,
    })
}

/// Whether the construction of a module has a closed form.
pub(super) fn is_closed(construction: &Construction) -> bool {
    match construction {
        Construction::SphericalTriple { polished, case: name, .. } => !polished && case(name).is_some(),
        Construction::ThreeParallel { polished } | Construction::Position { polished, .. } => !polished,
        Construction::General | Construction::TwoSlides { .. } => false,
        _ => true,
    }
}

/// Runs the construction of a module at a pose of a field. Marks the branches that close the loop, and returns the number of those with all
/// virtual joints at 0. The first branch that does not close the loop is the error, unless a missing value was compared.
pub(super) fn run(module: &Text, at: &At<'_>, sound: &mut [bool]) -> Result<usize, u16> {
    let own = Cell::new(0);
    branches(module, at, sound, &own).map(|()| own.get())
}

fn branches(module: &Text, at: &At<'_>, sound: &mut [bool], own: &Cell<usize>) -> Result<(), u16> {
    FIELD.set(Some(Field::new(at.closed.modulus)));
    UNKNOWN.set(false);
    let wrong = |signs: u16| if UNKNOWN.get() { Ok(()) } else { Err(signs) };
    let links = at.closed.links_at(&module.loops[0], at.pose);
    let joints = links.len();
    let mut judge = |values: &[[Real; 2]], signs: u16| {
        let numbers: Option<Vec<[u64; 2]>> = values.iter().map(|[c, s]| Some([c.value()?, s.value()?])).collect();
        let Some(numbers) = numbers else { return Ok(()) };
        if !at.closed.is_met(&module.loops[0].prismatic, &links, &numbers) {
            return wrong(signs);
        }
        if let Some(seen) = sound.get_mut(usize::from(signs)) {
            *seen = true;
        }
        let way = &module.loops[0];
        let places = way.order.iter().zip(&way.prismatic).zip(numbers.iter().zip(&at.closed.offsets));
        let mut virtual_joints = places.filter(|((joint, _), _)| **joint >= module.dof);
        let at_zero =
            virtual_joints.all(|((_, slides), (value, offset))| if *slides { value[0] == offset[0] } else { value == offset });
        own.set(own.get() + usize::from(at_zero));
        Ok(())
    };
    let six = || -> Option<[blocks::Frame; 6]> { (joints == 6).then(|| std::array::from_fn(|i| frame(&links[i]))) };
    match &module.construction {
        Construction::SphericalTriple { kinds, case: name, .. } => {
            let (Some(links), Some(case)) = (six(), case(name)) else { return Ok(()) };
            let found = blocks::spherical_triple(&links, [kinds[0], kinds[1], kinds[2]], case);
            found.found().iter().try_for_each(|branch| judge(&branch.joints, branch.signs))
        }
        Construction::ThreeParallel { .. } => {
            let Some(links) = six() else { return Ok(()) };
            blocks::three_parallel(&links).found().iter().try_for_each(|branch| judge(&branch.joints, branch.signs))
        }
        Construction::ThreePrismatic { turning } => {
            let Some(links) = six() else { return Ok(()) };
            let found = blocks::three_prismatic(&links, [turning[0], turning[1], turning[2]]);
            found.found().iter().try_for_each(|branch| judge(&branch.joints, branch.signs))
        }
        Construction::ParallelTurns { kinds, case: name } => {
            let Some(case) = case(name).filter(|_| joints == 4) else { return Ok(()) };
            let found = blocks::parallel_turns(&std::array::from_fn(|i| frame(&links[i])), [kinds[0], kinds[1], kinds[2]], case);
            found.found().iter().try_for_each(|branch| judge(&branch.joints, branch.signs))
        }
        Construction::Position { case: name, .. } => {
            let Some(case) = case(name).filter(|_| joints == 3) else { return Ok(()) };
            let (a, b) = (frame(&links[0]), frame(&links[1]));
            let [from, to] = at.closed.points(&module.loops[0], at.pose, at.tip).map(|point| point.map(real));
            let found = case(&a, &b, from, to);
            found.found().iter().try_for_each(|branch| {
                let numbers: Option<Vec<[u64; 2]>> = branch.joints.iter().map(|[c, s]| Some([c.value()?, s.value()?])).collect();
                let Some(numbers) = numbers else { return Ok(()) };
                let [from, to] = at.closed.points(&module.loops[0], at.pose, at.tip);
                if at.closed.moved(&module.loops[0].prismatic, &links, &numbers, from) != Some(to) {
                    return wrong(branch.signs);
                }
                if let Some(seen) = sound.get_mut(usize::from(branch.signs)) {
                    *seen = true;
                }
                Ok(())
            })
        }
        Construction::ShoulderElbowWrist => {
            let way = swivel_loop(at);
            let tangents = |joints: &[[Real; 2]; 7]| joints.map(|[c, s]| s / (Real::of(1.0) + c));
            let posture: Option<[[u64; 2]; 7]> = at.posture.try_into().ok();
            let Some(posture) = posture else { return Ok(()) };
            let swivel = blocks::swivel_angle(&way, &tangents(&posture.map(|value| value.map(real))));
            let found = blocks::shoulder_elbow_wrist(&way, &frame(at.pose), swivel);
            found.found().iter().try_for_each(|branch| {
                let own = blocks::swivel_angle(&way, &tangents(&way.of_arm(branch).joints));
                if own.value().is_some() && own != swivel {
                    return wrong(branch.signs);
                }
                judge(&branch.joints, branch.signs)
            })
        }
        Construction::General | Construction::TwoSlides { .. } => Ok(()),
    }
}

/// The loop of seven joints over the field.
fn swivel_loop(at: &At<'_>) -> blocks::Arrangement<7> {
    blocks::Arrangement {
        order: std::array::from_fn(|i| i),
        prismatic: [false; 7],
        links: std::array::from_fn(|i| frame(&at.closed.links[i])),
        open: 6,
        before: frame(&at.closed.before),
        after: frame(&at.closed.after),
        backward: false,
        offsets: std::array::from_fn(|i| at.closed.offsets[i].map(real)),
    }
}
