//! Angles of joints that follow others by no whole numbers: functions compute a sum and take its sine and cosine.
//!
//! At a random point the angles of one coordinate are related: each is a whole number of units, and a unit has a random point of the circle.
//! Then sin(2/3 p) and sin(1/3 p) satisfy there what they satisfy over the reals. Factors with roots or pi are related to their multiples
//! alone, and so are factors with more than 2^40 units.
//!
//! An angle in the text of a module is one of these, or a sum of joints about parallel axes, where its factors and its constant have the exact
//! values that follow from the description. A sum has the sine that the addition theorem gives it.

use std::collections::BTreeMap;

use armgen_description::exact::{Monomial, Number, Rational};
use armgen_description::manipulator::{Coupling, JointSum, JointVariable, Manipulator};
use dashu_base::{Gcd, Signed, UnsignedAbs};
use dashu_int::UBig;

use crate::values::arithmetic::Arithmetic;
use crate::values::element::Element;
use crate::values::formula::Formula;
use crate::values::program::{Angle, Program, Step};

/// A number of the description as a formula; only its text is used.
pub fn formula(number: &Number) -> Formula {
    Formula::parse(&number.to_string()).expect("the description prints its numbers as formulas")
}

/// The most units of an angle.
const MOST_UNITS: u64 = 1 << 40;
/// At rational points numbers get as long as an angle has units: the most of all angles together.
const MOST_AT_RATIONAL_POINTS: u64 = 1000;

/// A sum of coordinates with factors, and a constant.
#[derive(Clone, Debug)]
struct Sum {
    /// Coordinates, ascending, with the sizes of their factors and whether these are below 0.
    factors: Vec<(usize, Formula, bool)>,
    /// The size of the constant, and whether it is below 0.
    offset: (Formula, bool),
    /// What its sine and cosine follow from.
    parts: Vec<Part>,
}

/// A part of a sum.
#[derive(Clone, Debug)]
enum Part {
    /// An angle of a coordinate or of a sum before, so many times.
    Angle(usize, u64, bool),
    /// A constant angle, of which there are sine and cosine, and whether it is taken away.
    Constant([Formula; 2], bool),
}

/// A whole number of units, and whether they are taken away.
type Units = Vec<(usize, u64, bool)>;

/// The angles of an arm: of its coordinates, and those that functions compute.
#[derive(Clone, Debug)]
pub struct Angles {
    /// Number of coordinates.
    coordinates: usize,
    sums: Vec<Sum>,
    /// Units of each coordinate, and of the sum of each joint without its constant. A coordinate's first unit has its number.
    units: Vec<Units>,
    /// Number of units.
    count: usize,
}

/// The sine and cosine of a sum of two angles.
fn plus<E: Element>((s, c): &(E, E), (t, d): &(E, E)) -> (E, E) {
    (s.times(d).plus(&c.times(t)), c.times(d).minus(&s.times(t)))
}

/// The sine and cosine of so many times an angle.
fn multiple<E: Element>(point: &(E, E), count: u64) -> (E, E) {
    let mut result = point.clone();
    for bit in (0..count.ilog2()).rev() {
        result = plus(&result, &result);
        if count >> bit & 1 == 1 {
            result = plus(&result, point);
        }
    }
    result
}

impl Angles {
    /// Those of an arm.
    pub fn of(manipulator: &Manipulator) -> Angles {
        let coordinates = manipulator.dof();
        let computed = manipulator.coupling.as_ref().map_or_else(Vec::new, |coupling| coupling.computed());
        let size =
            |number: &Number| (formula(&if number.is_negative() { -number } else { number.clone() }), number.is_negative());
        let sum = |factors: BTreeMap<usize, Number>, offset: &Number, parts| {
            let factor = |(a, factor): (usize, Number)| {
                let (size, minus) = size(&factor);
                (a, size, minus)
            };
            Sum { factors: factors.into_iter().map(factor).collect(), offset: size(offset), parts }
        };
        let mut sums: Vec<Sum> = Vec::new();
        for angle in &computed {
            let factors = angle.factors.iter().map(|(a, factor)| (usize::from(*a), factor.clone()));
            let turn = Part::Constant(angle.turn.each_ref().map(formula), false);
            sums.push(sum(factors.collect(), &angle.offset, vec![turn]));
        }
        let place = |variable: &JointVariable| {
            let (angle, opposite) = variable.computed()?;
            Some((coordinates + computed.iter().position(|of| *of == angle)?, opposite))
        };
        if let Some(coupling) = &manipulator.coupling {
            for joints in coupling.sums.iter().filter(|sum| !sum.variable.is_whole) {
                let (factors, offset, parts) = added(coupling, joints, place);
                sums.push(sum(factors, &offset, parts));
            }
        }
        // By coordinate and irrational part: what angles have of it, the coordinate's own angle first.
        let mut shares: BTreeMap<(usize, Monomial), Vec<(usize, Rational)>> = BTreeMap::new();
        for a in 0..coordinates {
            shares.insert((a, Monomial::new()), vec![(a, Rational::ONE)]);
        }
        for (angle, index) in computed.iter().zip(coordinates..) {
            for (a, factor) in &angle.factors {
                for (part, share) in factor.terms() {
                    shares.entry((usize::from(*a), part.clone())).or_default().push((index, share.clone()));
                }
            }
        }
        let (mut units, mut count) = (vec![Units::new(); coordinates + computed.len()], coordinates);
        for ((a, part), shares) in shares {
            for (place, group) in groups(shares).into_iter().enumerate() {
                let unit = if place == 0 && part.is_empty() { a } else { count };
                count += usize::from(unit != a);
                group.into_iter().for_each(|(index, number, minus)| units[index].push((unit, number, minus)));
            }
        }
        Angles { coordinates, sums, units, count }
    }

    /// Number of coordinates.
    pub fn coordinates(&self) -> usize {
        self.coordinates
    }

    /// Number of random points of circles.
    pub fn circles(&self) -> usize {
        self.count
    }

    /// Whether there are angles that functions compute.
    pub fn are_computed(&self) -> bool {
        !self.sums.is_empty()
    }

    /// Whether numbers at rational points are short enough.
    pub fn have_rational_points(&self) -> bool {
        let all = self.units.iter().flatten().map(|(_, count, _)| *count);
        all.fold(0, u64::saturating_add) <= MOST_AT_RATIONAL_POINTS.max(self.coordinates as u64)
    }

    /// Random points of all angles, coordinates first.
    pub fn draw<K: Arithmetic>(&self, arithmetic: &mut K) -> Vec<(K::Element, K::Element)> {
        let points: Vec<_> = (0..self.count).map(|_| arithmetic.draw_angle()).collect();
        let nothing = || (arithmetic.integer(0), arithmetic.integer(1));
        let point = |units: &Units| {
            let part = |&(unit, count, minus): &(usize, u64, bool)| {
                let (sine, cosine) = multiple(&points[unit], count);
                (if minus { sine.negated() } else { sine }, cosine)
            };
            units.iter().map(part).reduce(|sum, part| plus(&sum, &part)).unwrap_or_else(nothing)
        };
        let mut all: Vec<(K::Element, K::Element)> = self.units[..self.coordinates].iter().map(point).collect();
        for (k, sum) in self.sums.iter().enumerate() {
            let part = |part: &Part| {
                let (circle, minus) = match part {
                    Part::Angle(index, count, minus) => (multiple(&all[*index], *count), minus),
                    Part::Constant(turn, minus) => {
                        let [sine, cosine] = turn.each_ref().map(|number| arithmetic.coordinate(number));
                        // A constant that divides by 0 refuses the arm elsewhere.
                        (sine.zip(cosine).unwrap_or_else(nothing), minus)
                    }
                };
                (if *minus { circle.0.negated() } else { circle.0 }, circle.1)
            };
            let own = self.units.get(self.coordinates + k).map_or_else(nothing, point);
            let circle = sum.parts.iter().map(part).fold(own, |sum, part| plus(&sum, &part));
            all.push(circle);
        }
        all
    }

    /// The values of computed angles at coordinates `q`; `None` where a constant has no value.
    pub fn values<K: Arithmetic>(&self, arithmetic: &K, q: &[K::Element]) -> Option<Vec<K::Element>> {
        let signed = |value: K::Element, minus: bool| if minus { value.negated() } else { value };
        let factors = self.factors(arithmetic)?;
        let value = |(sum, factors): (&Sum, Vec<(usize, K::Element)>)| {
            let offset = signed(arithmetic.constant(&sum.offset.0)?, sum.offset.1);
            Some(factors.iter().fold(offset, |sum, (a, factor)| sum.plus(&factor.times(&q[*a]))))
        };
        self.sums.iter().zip(factors).map(value).collect()
    }

    /// The factors of computed angles; `None` where a constant has no value.
    pub fn factors<K: Arithmetic>(&self, arithmetic: &K) -> Option<Vec<Vec<(usize, K::Element)>>> {
        let factor = |(a, size, minus): &(usize, Formula, bool)| {
            let size = arithmetic.constant(size)?;
            Some((*a, if *minus { size.negated() } else { size }))
        };
        self.sums.iter().map(|sum| sum.factors.iter().map(factor).collect()).collect()
    }

    /// Tells which computed angles a program takes sines of, its literals having these values.
    ///
    /// # Errors
    /// The sine of a sum that is none of them.
    pub fn name(&self, program: &mut Program, values: &[Formula]) -> Result<(), String> {
        let turns = &program.turns;
        for step in &mut program.steps {
            let (Step::Sine(angle) | Step::Cosine(angle)) = step else { continue };
            angle.computed = self.sums.iter().position(|sum| sum.is(angle, turns, values));
            if angle.computed.is_none() && !angle.factors.is_empty() {
                return Err("it takes the sine of a sum that is no joint variable of the description".into());
            }
        }
        Ok(())
    }
}

/// The sum of joints about parallel axes: its factors by coordinate, its constant, and the angles that it adds. Its first factor is positive, as
/// those of computed angles are. `computed` has the place of a joint's computed angle, and whether the joint has the opposite.
fn added(
    coupling: &Coupling,
    joints: &JointSum,
    computed: impl Fn(&JointVariable) -> Option<(usize, bool)>,
) -> (BTreeMap<usize, Number>, Number, Vec<Part>) {
    let (mut factors, mut offset): (BTreeMap<usize, Number>, Number) = (BTreeMap::new(), Number::zero());
    let terms: Vec<(&JointVariable, bool)> =
        joints.joints.terms().map(|(joint, minus)| (&coupling.variables[usize::from(joint)], minus)).collect();
    let signed = |number: &Number, minus: bool| if minus { -number } else { number.clone() };
    for &(variable, minus) in &terms {
        for (a, factor) in &variable.factors {
            let sum = factors.entry(*a).or_insert_with(Number::zero);
            *sum = sum.plus(&signed(factor, minus));
        }
        offset = offset.plus(&signed(&variable.offset, minus));
    }
    factors.retain(|_, factor| !factor.is_zero());
    let flip = factors.values().next().is_some_and(Number::is_negative);
    factors.values_mut().for_each(|factor| *factor = signed(factor, flip));
    let mut parts = Vec::new();
    for (variable, minus) in terms {
        let minus = minus != flip;
        if let Some((place, opposite)) = computed(variable) {
            parts.push(Part::Angle(place, 1, minus != opposite));
            continue;
        }
        let whole = |(a, factor): &(usize, Number)| Part::Angle(*a, factor.to_f64().abs() as u64, minus != factor.is_negative());
        parts.extend(variable.factors.iter().map(whole));
        parts.extend(variable.turn.iter().map(|turn| Part::Constant(turn.each_ref().map(formula), minus)));
    }
    (factors, signed(&offset, flip), parts)
}

impl Sum {
    /// Whether an angle of a text is this sum.
    fn is(&self, angle: &Angle, turns: &[usize], values: &[Formula]) -> bool {
        let one = Formula::Rational(Rational::ONE);
        let factor = |i: usize| angle.factors.get(i).copied().flatten().map_or(&one, |literal| &values[literal]);
        let own = angle.terms.iter().enumerate().map(|(i, (a, sign))| (a, factor(i), *sign < 0));
        let zero = Formula::Rational(Rational::ZERO);
        let offset = angle.turn.map_or((&zero, false), |(k, minus)| (&values[turns[k]], minus));
        own.eq(self.factors.iter().map(|(a, size, minus)| (a, size, *minus))) && offset == (&self.offset.0, self.offset.1)
    }
}

/// Groups of angles that have one unit: each angle joins the first group where all are at most so many units.
fn groups(shares: Vec<(usize, Rational)>) -> Vec<Vec<(usize, u64, bool)>> {
    let most = UBig::from(MOST_UNITS);
    // The numbers of units of a group, if they are few enough.
    let counted = |group: &[(usize, Rational)]| -> Option<Vec<(usize, u64, bool)>> {
        let first = &group[0].1;
        let ratios: Vec<Rational> = group.iter().map(|(_, share)| share / first).collect();
        let common = ratios.iter().fold(UBig::ONE, |common, ratio| {
            let denominator = ratio.denominator();
            &common / (&common).gcd(denominator) * denominator
        });
        let count = |((index, share), ratio): (&(usize, Rational), &Rational)| {
            let count = &common / ratio.denominator() * ratio.numerator().unsigned_abs();
            (count <= most).then(|| (*index, u64::try_from(&count).unwrap_or(1), share.is_negative()))
        };
        group.iter().zip(&ratios).map(count).collect()
    };
    let mut groups: Vec<Vec<(usize, Rational)>> = Vec::new();
    for share in shares {
        let fits =
            |group: &&mut Vec<(usize, Rational)>| counted(&[group.as_slice(), std::slice::from_ref(&share)].concat()).is_some();
        match groups.iter_mut().find(fits) {
            Some(group) => group.push(share),
            None => groups.push(vec![share]),
        }
    }
    groups.iter().filter_map(|group| counted(group)).collect()
}
