//! The determinant of the task Jacobian, its factors and the singular configurations.
//!
//! ```text
//! det J(q) = 0: the end effector loses a direction of the task                          (the book, Sect. 3.3)
//! ```
//!
//! The determinant is expanded by minors, each set of columns once. Joint variables that it does not depend on, which their zero
//! derivative proves, are set to 0 first. The rest is factored as far as single joint variables allow. It is a polynomial in one
//! variable, whose coefficients contain the other harmonics. Its content in that variable is the greatest common divisor of
//! univariate polynomials, in tan(q/2) for an angle.

use std::collections::{BTreeMap, BTreeSet};

use super::arm::Arm;
use super::parameters::View;
use super::quantities::kinematics::geometric_jacobian;
use crate::exact::{Angle, Number, Rational};
use crate::ring::field::computed::ComputedAngles;
use crate::ring::normal_form::{Harmonic, NormalForm, Powers};
use crate::ring::print::{Notation, Printer};
use crate::ring::{ExprId, Pool, Symbol};
use crate::Model;

pub mod minors;
mod univariate;

use univariate::Univariate;

/// The determinant of a square task Jacobian.
#[derive(Clone)]
pub struct Determinant {
    /// The expression's pool.
    pub pool: Pool,
    /// The determinant.
    pub value: ExprId,
    /// Its closed form, if it is not too long.
    pub form: Option<NormalForm>,
    /// Its factors, whose product it is, if there is a closed form.
    pub factors: Vec<Factor>,
}

/// A factor of the determinant.
#[derive(Clone, Debug)]
pub struct Factor {
    /// Its closed form.
    pub form: NormalForm,
    /// Where it is zero.
    pub zeros: Zeros,
}

/// Where a factor of a determinant is zero.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Zeros {
    /// Nowhere.
    Never,
    /// At every q.
    Everywhere,
    /// For some values of parameters: the factor contains parameters alone.
    OfParameters,
    /// At values of one joint variable: `q2 = 0 mod pi`, in plain text and in LaTeX.
    Of([String; 2]),
    /// Where several joints together make it so.
    OfSeveralJoints,
}

impl Zeros {
    /// In a few words; none where several joints together decide.
    pub fn words(&self) -> Option<&str> {
        match self {
            Zeros::Never => Some("never"),
            Zeros::Everywhere => Some("at every q"),
            Zeros::OfParameters => Some("where its parameters alone make it so"),
            Zeros::Of([text, _]) => Some(text),
            Zeros::OfSeveralJoints => None,
        }
    }

    /// As a sentence about the factor.
    pub fn sentence(&self) -> String {
        match self {
            Zeros::Never => "never zero".into(),
            Zeros::Everywhere => "zero at every q".into(),
            Zeros::OfParameters => "zero where its parameters alone make it so".into(),
            Zeros::Of([text, _]) => format!("zero at {text}"),
            Zeros::OfSeveralJoints => "zero where several joints together make it so".into(),
        }
    }
}

/// Most terms, intermediate forms included, of a closed form of the determinant.
const TERMS: usize = 4000;

/// The determinant of the task Jacobian; none where that is not square.
pub fn determinant(model: &Model, view: View<'_>) -> Option<Determinant> {
    let manipulator = &model.manipulator;
    if manipulator.task.len() != manipulator.dof() {
        return None;
    }
    let mut pool = Pool::new(model.field.clone());
    let arm = Arm::new(&mut pool, manipulator, view);
    let jacobian = geometric_jacobian(&mut pool, &arm);
    let (mut pool, jacobian) = in_coordinates(pool, &arm, jacobian);
    let task: Vec<Vec<ExprId>> = manipulator.task.iter().map(|row| jacobian[row.index()].clone()).collect();
    let value = of_columns(&mut pool, &task)[(1 << task.len()) - 1];
    let (mut simple, task) = without_fixed(&mut pool, &[value], &task);
    let reduced = of_columns(&mut simple, &task)[(1 << task.len()) - 1];
    debug_assert!(simple.fingerprint(reduced) == pool.fingerprint(value));
    let form = simple.normal_forms(&[reduced], TERMS).remove(0);
    let angles = simple.field().computed().map(|computed| &**computed);
    let factors = form.as_ref().map_or_else(Vec::new, |form| factors(model, angles, form));
    Some(Determinant { pool: simple, value: reduced, form, factors })
}

/// A Jacobian with a column for each joint as that of the coordinates, J S.
fn in_coordinates(mut pool: Pool, arm: &Arm, jacobian: Vec<Vec<ExprId>>) -> (Pool, Vec<Vec<ExprId>>) {
    let jacobian = arm.project_columns(&mut pool, jacobian);
    let (pool, entries) = arm.in_coordinates(pool, jacobian.concat());
    (pool, entries.chunks(arm.coordinates()).map(<[ExprId]>::to_vec).collect())
}

/// A matrix in a pool of its own, with those joint variables set to 0 that none of some values depends on.
fn without_fixed(pool: &mut Pool, values: &[ExprId], matrix: &[Vec<ExprId>]) -> (Pool, Vec<Vec<ExprId>>) {
    let columns = matrix[0].len();
    let mut simple = Pool::new(pool.field().clone());
    // A computed angle holds coordinates that it is not taken apart into.
    let all = 0..if pool.field().computed().is_some() { 0 } else { columns as u16 };
    let fixed: Vec<u16> = all.filter(|&i| pool.partial_derivative(values, i).iter().all(|d| *d == ExprId::ZERO)).collect();
    let entries = pool.substitute_into(&mut simple, &matrix.concat(), &|pool, symbol| match symbol {
        Symbol::Sine(i) | Symbol::Position(i) if fixed.contains(&i) => ExprId::ZERO,
        Symbol::Cosine(i) if fixed.contains(&i) => ExprId::ONE,
        _ => pool.symbol(symbol),
    });
    (simple, entries.chunks(columns).map(<[ExprId]>::to_vec).collect())
}

/// The determinants of the first rows of a matrix, by sets of as many columns: Laplace's expansion along rows, each set once.
fn of_columns(pool: &mut Pool, matrix: &[Vec<ExprId>]) -> Vec<ExprId> {
    let n = matrix[0].len();
    let mut of_set: Vec<ExprId> = vec![ExprId::ZERO; 1 << n];
    of_set[0] = ExprId::ONE;
    for set in (1usize..1 << n).filter(|set| set.count_ones() as usize <= matrix.len()) {
        let row = set.count_ones() as usize - 1;
        let mut sum = ExprId::ZERO;
        for (place, column) in (0..n).filter(|c| set >> c & 1 == 1).enumerate() {
            let term = pool.mul(matrix[row][column], of_set[set & !(1 << column)]);
            sum = pool.add(sum, term.signed((row + place) % 2 == 1));
        }
        of_set[set] = sum;
    }
    of_set
}

/// A joint variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Variable {
    Angle(u16),
    Position(u16),
}

/// The factors of a form: contents in single variables, then what is left; the constant factor goes into the first.
fn factors(model: &Model, angles: Option<&ComputedAngles>, form: &NormalForm) -> Vec<Factor> {
    let (mut found, mut rest) = contents(model, angles, vec![form.clone()]);
    let rest = rest.remove(0);
    let constant = rest.terms().all(|(harmonic, factors, _)| harmonic.angles.is_empty() && factors.is_empty());
    if constant || found.is_empty() {
        let scale = rest;
        match found.first_mut() {
            Some((first, _)) => *first = first.times(&scale, TERMS).expect("a constant adds no terms"),
            None => {
                let zeros = zeros_without_joints(&scale);
                found.push((scale, zeros));
            }
        }
    } else {
        let zeros = zeros_without_joints(&rest);
        found.push((rest, zeros));
    }
    found.into_iter().map(|(form, zeros)| Factor { form, zeros }).collect()
}

/// The contents that some forms share in single variables, with their zeros, and each form divided by them. A computed angle, one of `computed`, is a
/// variable by itself: what is a product whatever the angles is a product where they are related.
fn contents(
    model: &Model,
    computed: Option<&ComputedAngles>,
    mut rest: Vec<NormalForm>,
) -> (Vec<(NormalForm, Zeros)>, Vec<NormalForm>) {
    let mut found = Vec::new();
    let angles: BTreeSet<u16> = rest.iter().flat_map(NormalForm::angles).collect();
    let positions: BTreeSet<u16> = rest.iter().flat_map(positions).collect();
    for variable in angles.into_iter().map(Variable::Angle).chain(positions.into_iter().map(Variable::Position)) {
        if let Some((parts, quotients)) = content(model, computed, &rest, variable) {
            rest = quotients;
            found.extend(parts);
        }
    }
    (found, rest)
}

/// The joints whose displacements occur in a form.
fn positions(form: &NormalForm) -> Vec<u16> {
    let all = form.terms().flat_map(|(_, factors, _)| factors);
    let all: BTreeSet<u16> = all.filter_map(|(s, _)| if let Symbol::Position(i) = s { Some(*i) } else { None }).collect();
    all.into_iter().collect()
}

/// Where the factor that is left after all contents is zero.
fn zeros_without_joints(form: &NormalForm) -> Zeros {
    if !form.angles().is_empty() || !positions(form).is_empty() {
        Zeros::OfSeveralJoints
    } else if form.is_empty() {
        Zeros::Everywhere
    } else if form.terms().all(|(_, factors, _)| factors.is_empty()) {
        Zeros::Never
    } else {
        Zeros::OfParameters
    }
}

/// The content of some forms in one variable, in factors with their zeros, and the quotients; `None` without a common factor.
fn content(
    model: &Model,
    computed: Option<&ComputedAngles>,
    forms: &[NormalForm],
    variable: Variable,
) -> Option<(Vec<(NormalForm, Zeros)>, Vec<NormalForm>)> {
    let groups: Vec<_> = forms.iter().map(|form| split(form, variable)).collect();
    let all = || groups.iter().flat_map(BTreeMap::values);
    let degree = all().map(Univariate::degree).max()?;
    let is_angle = matches!(variable, Variable::Angle(_));
    let mut field = model.field.clone();
    let polynomials: Vec<Univariate> = all().map(|polynomial| polynomial.to_degree(degree, is_angle)).collect();
    // Roots at infinity (an angle of pi) that all share.
    let infinite = if is_angle { polynomials.iter().map(|p| degree - p.proper_degree()).min().unwrap_or(0) } else { 0 };
    let divisor = univariate::gcd_of_all(&mut field, polynomials);
    let total = divisor.proper_degree() + infinite;
    if total == 0 || (is_angle && total % 2 == 1) {
        return None;
    }
    let mut quotients = Vec::new();
    for groups in &groups {
        let mut quotient = NormalForm::default();
        for ((harmonic, factors), polynomial) in groups {
            let part = univariate::divide(&mut field, &polynomial.to_degree(degree, is_angle), &divisor);
            let part = from_univariate(&part, variable, degree - total);
            let carrier = NormalForm::term(harmonic.clone(), factors.clone(), Number::one());
            for (harmonic, factors, c) in part.times(&carrier, usize::MAX)?.terms() {
                quotient.add_term(harmonic.clone(), factors.clone(), c.clone());
            }
        }
        quotients.push(quotient);
    }
    let parts = univariate::split_known_roots(&mut field, &divisor, infinite, is_angle)
        .into_iter()
        .map(|(part, degree)| {
            let form = from_univariate(&part, variable, degree);
            let zeros = zeros(&form, computed, variable, &part);
            (form, zeros)
        })
        .collect();
    // The pieces carry scales (sin q is 2t/(1 + t²)): each is scaled to a leading coefficient of 1, and the quotients take the product of the scales.
    let (parts, scale) = normalised(parts);
    Some((parts, quotients.iter().map(|quotient| quotient.scaled(&scale)).collect()))
}

/// Scales each factor to a leading coefficient of 1, and returns the product of what was taken out.
fn normalised(parts: Vec<(NormalForm, Zeros)>) -> (Vec<(NormalForm, Zeros)>, Number) {
    let mut scale = Number::one();
    let parts = parts
        .into_iter()
        .map(|(form, zeros)| {
            let groups = form.by_harmonic();
            let leading = groups[0].1[0].1.clone();
            let inverse = Number::one().checked_div(&leading).expect("a term is not zero");
            scale = &scale * &leading;
            (form.scaled(&inverse), zeros)
        })
        .collect();
    (parts, scale)
}

/// A form as polynomials in one variable, by what they are multiplied with.
fn split(form: &NormalForm, variable: Variable) -> BTreeMap<(Harmonic, Powers), Univariate> {
    let mut groups: BTreeMap<(Harmonic, Powers), Univariate> = BTreeMap::new();
    for (harmonic, factors, c) in form.terms() {
        match variable {
            Variable::Position(i) => {
                let power = factors.iter().find(|(s, _)| *s == Symbol::Position(i)).map_or(0, |(_, p)| *p as usize);
                let others = factors.iter().filter(|(s, _)| *s != Symbol::Position(i)).copied().collect();
                groups.entry((harmonic.clone(), others)).or_default().add(&Univariate::monomial(power, c.clone()));
            }
            Variable::Angle(i) => {
                let k = harmonic.angles.iter().find(|(a, _)| *a == i).map_or(0, |(_, k)| *k);
                let others: Vec<(u16, i32)> = harmonic.angles.iter().filter(|(a, _)| *a != i).copied().collect();
                // sin(r + kq) = sin r cos kq + cos r sin kq, cos(r + kq) = cos r cos kq - sin r sin kq; r leads with a positive coefficient or flips.
                let flip = others.first().is_some_and(|(_, k)| *k < 0);
                let carrier: Vec<(u16, i32)> = others.iter().map(|(a, k)| (*a, if flip { -k } else { *k })).collect();
                let mut push = |sine: bool, part: Univariate, negative: bool| {
                    if carrier.is_empty() && sine {
                        return;
                    }
                    let negative = negative != (sine && flip);
                    let key = (Harmonic { angles: carrier.clone(), sine }, factors.clone());
                    groups.entry(key).or_default().add(&if negative { part.negated() } else { part });
                };
                let (cosine, sine) = (Univariate::harmonic(k, false, c), Univariate::harmonic(k, true, c));
                if harmonic.sine {
                    push(true, cosine, false);
                    push(false, sine, false);
                } else {
                    push(false, cosine, false);
                    push(true, sine, true);
                }
            }
        }
    }
    groups.retain(|_, polynomial| !polynomial.is_zero());
    groups
}

/// The form of a polynomial: of t^j as sin^j(q/2) cos^(degree - j)(q/2), or of q^j.
fn from_univariate(polynomial: &Univariate, variable: Variable, degree: usize) -> NormalForm {
    let mut form = NormalForm::default();
    for (power, c) in polynomial.coefficients().iter().enumerate().filter(|(_, c)| !c.is_zero()) {
        let term = match variable {
            Variable::Position(i) => {
                let factors = if power == 0 { Vec::new() } else { vec![(Symbol::Position(i), power as u32)] };
                NormalForm::term(Harmonic::one(), factors, c.clone())
            }
            Variable::Angle(i) => half_angle_term(i, power, degree - power, c),
        };
        for (harmonic, factors, c) in term.terms() {
            form.add_term(harmonic.clone(), factors.clone(), c.clone());
        }
    }
    form
}

/// c sin^a(q/2) cos^b(q/2), a + b even.
fn half_angle_term(angle: u16, a: usize, b: usize, c: &Number) -> NormalForm {
    let half = Number::from(Rational::from_parts(1.into(), 2u8.into()));
    let harmonic = |sine: bool, c: Number| NormalForm::term(Harmonic { angles: vec![(angle, 1)], sine }, Vec::new(), c);
    let mut form = NormalForm::term(Harmonic::one(), Vec::new(), c.clone());
    let mut multiply = |factor: &NormalForm| form = form.times(factor, usize::MAX).expect("no limit");
    if a % 2 == 1 {
        multiply(&harmonic(true, half.clone()));
    }
    let with_cosine = |negative: bool| {
        let mut sum = harmonic(false, if negative { -&half } else { half.clone() });
        sum.add_term(Harmonic::one(), Vec::new(), half.clone());
        sum
    };
    (0..a / 2).for_each(|_| multiply(&with_cosine(true)));
    (0..b / 2).for_each(|_| multiply(&with_cosine(false)));
    form
}

/// Values of a joint variable in both notations, each as `print` gives it.
fn at(computed: Option<&ComputedAngles>, print: impl Fn(&Printer<'_>) -> String) -> Zeros {
    Zeros::Of(
        [Notation::Text, Notation::Latex]
            .map(|notation| print(&Printer { notation, parameters: &[], velocities: &[], computed, digits: None })),
    )
}

/// Where a factor in one variable is zero.
fn zeros(form: &NormalForm, computed: Option<&ComputedAngles>, variable: Variable, polynomial: &Univariate) -> Zeros {
    let at = |print: &dyn Fn(&Printer<'_>) -> String| at(computed, print);
    let coefficient = |angles: Vec<(u16, i32)>, sine: bool| {
        form.terms().find(|(w, _, _)| w.angles == angles && w.sine == sine).map_or(Number::zero(), |(_, _, c)| c.clone())
    };
    let (Variable::Position(i) | Variable::Angle(i)) = variable;
    let name = |printer: &Printer<'_>| match variable {
        Variable::Position(i) => printer.symbol(Symbol::Position(i)),
        Variable::Angle(i) => printer.angle_of(i),
    };
    let implicitly = || {
        at(&|printer| match printer.notation {
            Notation::Text => format!("{} with {} = 0", name(printer), printer.form(form)),
            Notation::Latex => format!("{} \\text{{ with }} {} = 0", name(printer), printer.form(form)),
        })
    };
    if let Variable::Position(_) = variable {
        return match polynomial.coefficients() {
            [zero, one] => {
                let root = (-zero).checked_div(one).expect("the leading coefficient is not zero");
                at(&|printer| format!("{} = {}", name(printer), printer.number(&root)))
            }
            [zero, one, two] => quadratic(&name, zero, one, two),
            _ => implicitly(),
        };
    }
    let highest = form.terms().map(|(w, _, _)| w.order()).max().unwrap_or(0);
    let (a, b, c) = (coefficient(vec![(i, 1)], false), coefficient(vec![(i, 1)], true), coefficient(Vec::new(), false));
    if highest != 1 {
        return implicitly();
    }
    let modulo_pi = |value: &dyn Fn(&Printer<'_>) -> String| at(&|p| format!("{} = {}{}", name(p), value(p), modulo(p, "")));
    match (a.is_zero(), b.is_zero(), c.is_zero()) {
        (true, false, true) => modulo_pi(&|_| "0".into()),
        (false, true, true) => modulo_pi(&|printer| fraction_of_pi(printer, 1, 2)),
        (false, false, true) => {
            let ratio = (-&a).checked_div(&b).expect("b is not zero");
            modulo_pi(&|printer| call(printer, "atan", "\\arctan", &printer.number(&ratio)))
        }
        _ => linear_with_constant(&at, &name, &a, &b, &c),
    }
}

/// ` mod 2 pi`; the factor before pi is an argument.
fn modulo(printer: &Printer<'_>, factor: &str) -> String {
    match (printer.notation, factor) {
        (Notation::Text, "") => " mod pi".into(),
        (Notation::Text, _) => format!(" mod {factor} pi"),
        (Notation::Latex, "") => " \\pmod{\\pi}".into(),
        (Notation::Latex, _) => format!(" \\pmod{{{factor} \\pi}}"),
    }
}

fn fraction_of_pi(printer: &Printer<'_>, numerator: i64, denominator: i64) -> String {
    match (printer.notation, numerator, denominator) {
        (Notation::Text, n, 1) => {
            if n == 0 {
                "0".into()
            } else {
                "pi".into()
            }
        }
        (Notation::Text, 1, d) => format!("pi/{d}"),
        (Notation::Text, n, d) => format!("{n} pi/{d}"),
        (Notation::Latex, n, 1) => {
            if n == 0 {
                "0".into()
            } else {
                "\\pi".into()
            }
        }
        (Notation::Latex, 1, d) => format!("\\frac{{\\pi}}{{{d}}}"),
        (Notation::Latex, n, d) => format!("\\frac{{{n} \\pi}}{{{d}}}"),
    }
}

/// A function of a name in plain text and one in LaTeX.
fn call(printer: &Printer<'_>, text: &str, latex: &str, inside: &str) -> String {
    match printer.notation {
        Notation::Text => format!("{text}({inside})"),
        Notation::Latex => format!("{latex}\\left({inside}\\right)"),
    }
}

/// c + b q + a q² = 0.
fn quadratic(name: &dyn Fn(&Printer<'_>) -> String, c: &Number, b: &Number, a: &Number) -> Zeros {
    let root = |numerator: Number| numerator.checked_div(&(a * &Number::from(2))).expect("the leading coefficient is not zero");
    let discriminant = &(b * b) - &(&(a * c) * &Number::from(4));
    match discriminant.sqrt() {
        None => Zeros::Never,
        Some(zero) if zero.is_zero() => {
            let root = root(-b);
            at(None, |printer| format!("{} = {}", name(printer), printer.number(&root)))
        }
        Some(width) => {
            let roots = [root(&-b - &width), root(&-b + &width)];
            at(None, |printer| {
                let [low, high] = roots.each_ref().map(|root| printer.number(root));
                let or = if printer.notation == Notation::Text { " or " } else { " \\text{ or } " };
                format!("{} = {low}{or}{high}", name(printer))
            })
        }
    }
}

/// a cos q + b sin q + c = 0.
fn linear_with_constant(
    at: &dyn Fn(&dyn Fn(&Printer<'_>) -> String) -> Zeros,
    name: &dyn Fn(&Printer<'_>) -> String,
    a: &Number,
    b: &Number,
    c: &Number,
) -> Zeros {
    let square = &(a * a) + &(b * b);
    if (&square - &(c * c)).sign() == std::cmp::Ordering::Less {
        return Zeros::Never;
    }
    let radius = square.sqrt().expect("a sum of squares");
    let ratio = (-c).checked_div(&radius).expect("a harmonic is there");
    let at_origin = b.is_zero() && a.sign() == std::cmp::Ordering::Greater;
    // cos(q - centre) = ratio
    let exact = [(0i64, 1i64), (1, 6), (1, 4), (1, 3), (1, 2), (2, 3), (3, 4), (5, 6), (1, 1)].into_iter().find(|&(n, d)| {
        let part = Number::from(Rational::from(n) / Rational::from(d));
        Angle::new(&part * &Number::pi()).cos() == ratio
    });
    at(&|printer| {
        let text = printer.notation == Notation::Text;
        let centre = call(printer, "atan2", "\\operatorname{atan2}", &format!("{}, {}", printer.number(b), printer.number(a)));
        let opening = match exact {
            Some((n, d)) => fraction_of_pi(printer, n, d),
            None => call(printer, "acos", "\\arccos", &printer.number(&ratio)),
        };
        let both = if text { "+-" } else { "\\pm" };
        let value = match (exact, at_origin) {
            (Some((0, _)), true) => "0".into(),
            (Some((0, _)), false) => centre,
            (Some((1, 1)), true) => opening,
            (Some((1, 1)), false) => format!("{centre} + {opening}"),
            (_, true) => format!("{both}{}{opening}", if text { "" } else { " " }),
            (_, false) => format!("{centre} {both} {opening}"),
        };
        format!("{} = {value}{}", name(printer), modulo(printer, "2"))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zeros_of_a_quadratic_factor() {
        let name = |printer: &Printer<'_>| printer.symbol(Symbol::Position(0));
        let zeros = |c: i64, b: i64, a: i64| quadratic(&name, &c.into(), &b.into(), &a.into());
        assert_eq!(zeros(1, 2, 1).words(), Some("q1 = -1"));
        assert_eq!(zeros(3, -4, 1).words(), Some("q1 = 1 or 3"));
        assert_eq!(zeros(-2, 0, 1).words(), Some("q1 = -sqrt(2) or sqrt(2)"));
        assert_eq!(zeros(1, 0, 1).words(), Some("never"));
    }
}
