//! Where a task Jacobian with one column more than rows loses rank.
//!
//! ```text
//! D_k = det(J without column k),   det(J J') = D_1² + ... + D_n²                                  (Cauchy and Binet)
//! ```
//!
//! J has full rank where one of its minors D_k is not 0. The factors that all of them share are taken out first: where one of these is 0,
//! J loses rank. Elsewhere it does where all that is left is 0 together.
//!
//! A task of all six rows may be seen from any link: a twist in other axes and about another point is the old one times a matrix of
//! determinant 1. From the middle of the arm the columns, and so the minors on the way to their closed forms, are the shortest.

use dashu_base::{Gcd, UnsignedAbs};

use super::{contents, factors, in_coordinates, of_columns, without_fixed, zeros_without_joints, Factor, Zeros, TERMS};
use crate::derive::arm::Arm;
use crate::derive::parameters::View;
use crate::derive::quantities::kinematics::geometric_jacobian;
use crate::exact::{Number, Rational};
use crate::ring::field::computed::ComputedAngles;
use crate::ring::matrix::{Vector, IDENTITY, ZERO};
use crate::ring::normal_form::{Harmonic, NormalForm, Powers};
use crate::ring::{ExprId, Pool, Symbol};
use crate::Model;

/// The minors of a task Jacobian with one column more than rows.
#[derive(Clone)]
pub struct Minors {
    /// The pool of `values`.
    pub pool: Pool,
    /// D_k by k.
    pub values: Vec<ExprId>,
    /// The factors that all of them share.
    pub common: Vec<Factor>,
    /// The remainders d_k: each D_k over the product of the shared factors.
    pub left: Vec<Product>,
}

/// A product of closed forms.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Product {
    /// Its constant factor.
    pub coefficient: Number,
    /// Its other factors; a factor of a power occurs repeatedly.
    pub factors: Vec<NormalForm>,
}

impl Product {
    const fn of(coefficient: Number) -> Product {
        Product { coefficient, factors: Vec::new() }
    }

    /// -self.
    pub fn negated(&self) -> Product {
        Product { coefficient: -&self.coefficient, factors: self.factors.clone() }
    }

    /// Whether it is a number but 0.
    pub fn is_never_zero(&self) -> bool {
        self.factors.is_empty() && !self.coefficient.is_zero()
    }
}

/// Most terms of all different minors together that are factored. Their coefficients are of fractions and roots: greatest common divisors of
/// others, as of sines of general angles, can take minutes, and equal ones need not look equal.
const FACTORED_TERMS: usize = 1500;

/// Most terms of all that is left of them together: about a screen. Those of a Panda, whose minors share no factor, are 365.
const LEFT_TERMS: usize = 150;

/// Why there are no minors to show.
#[derive(Clone, Debug)]
pub enum NoMinors {
    /// The task has as many rows as the arm has joints, or more.
    NotRedundant,
    /// The arm has more than one degree of redundancy.
    TooMany,
    /// They are too long to be read, or have coefficients that are no fractions and roots; the factors that they share, if known.
    TooLong(Vec<Factor>),
    /// All of them are 0.
    AllZero,
}

/// The minors of an arm with one joint more than its task has rows.
pub fn minors(model: &Model, view: View<'_>) -> Result<Minors, NoMinors> {
    let manipulator = &model.manipulator;
    match manipulator.dof().checked_sub(manipulator.task.len()) {
        None | Some(0) => return Err(NoMinors::NotRedundant),
        Some(1) => {}
        Some(_) => return Err(NoMinors::TooMany),
    }
    let mut pool = Pool::new(model.field.clone());
    let arm = Arm::new(&mut pool, manipulator, view);
    let jacobian = if manipulator.task.len() == 6 { twists(&mut pool, &arm) } else { geometric_jacobian(&mut pool, &arm) };
    let (mut pool, jacobian) = in_coordinates(pool, &arm, jacobian);
    let task: Vec<Vec<ExprId>> = manipulator.task.iter().map(|row| jacobian[row.index()].clone()).collect();
    let all = without_each(&mut pool, &task);
    let (mut pool, task) = without_fixed(&mut pool, &all, &task);
    let values = without_each(&mut pool, &task);
    // Equal ones once, whatever their signs.
    let mut different: Vec<ExprId> = values.iter().map(|value| value.unsigned()).filter(|value| *value != ExprId::ZERO).collect();
    different.sort_unstable();
    different.dedup();
    if different.is_empty() {
        return Err(NoMinors::AllZero);
    }
    let total = |sizes: &mut dyn Iterator<Item = usize>| sizes.fold(0, usize::saturating_add);
    let forms = pool.all_normal_forms(&different, TERMS).ok_or(NoMinors::TooLong(Vec::new()))?;
    let reduced = forms.iter().flat_map(NormalForm::terms).all(|(_, _, c)| c.is_reduced());
    if !reduced || total(&mut forms.iter().map(NormalForm::size)) > FACTORED_TERMS {
        return Err(NoMinors::TooLong(Vec::new()));
    }
    let angles = pool.field().computed().map(|computed| &**computed);
    let (common, left) = taken_apart(model, angles, forms);
    if total(&mut left.iter().flat_map(|product| &product.factors).map(NormalForm::size)) > LEFT_TERMS {
        return Err(NoMinors::TooLong(common));
    }
    let left = values
        .iter()
        .map(|value| match different.binary_search(&value.unsigned()) {
            Ok(k) if value.is_negated() => left[k].negated(),
            Ok(k) => left[k].clone(),
            Err(_) => Product::of(Number::zero()),
        })
        .collect();
    Ok(Minors { pool, values, common, left })
}

/// The determinants of a matrix with one column more than rows, without each column.
fn without_each(pool: &mut Pool, matrix: &[Vec<ExprId>]) -> Vec<ExprId> {
    let of_set = of_columns(pool, matrix);
    let all = of_set.len() - 1;
    (0..matrix[0].len()).map(|column| of_set[all & !(1 << column)]).collect()
}

/// The twist of the end effector for each rate, about the origin and in the axes of the joint frame in the middle of the arm: six rows.
fn twists(pool: &mut Pool, arm: &Arm) -> Vec<Vec<ExprId>> {
    let path = arm.path_to(arm.tool.link);
    let middle = path.len() / 2;
    let mut rows = vec![vec![ExprId::ZERO; arm.dof()]; 6];
    let mut set = |pool: &mut Pool, i: usize, axis: &Vector, origin: &Vector| {
        let turns = arm.joints[i].is_revolute();
        let linear = if turns { pool.cross(origin, axis) } else { *axis };
        for row in 0..3 {
            rows[row][i] = linear[row];
            rows[row + 3][i] = if turns { axis[row] } else { ExprId::ZERO };
        }
    };
    for (k, &i) in path[..=middle].iter().enumerate() {
        let (mut axis, mut origin) = (IDENTITY[2], ZERO);
        for &j in &path[k + 1..=middle] {
            let joint = &arm.joints[j];
            let seen = pool.sub_vectors(&origin, &joint.origin);
            (axis, origin) = (joint.from_parent(pool, &axis), joint.from_parent(pool, &seen));
        }
        set(pool, i, &axis, &origin);
    }
    let (mut rotation, mut origin) = (IDENTITY, ZERO);
    for &i in &path[middle + 1..] {
        let joint = &arm.joints[i];
        let step = pool.transform(&rotation, &joint.origin);
        origin = pool.add_vectors(&origin, &step);
        let turn = joint.rotation(pool);
        rotation = pool.product(&rotation, &turn);
        set(pool, i, &rotation.map(|row| row[2]), &origin);
    }
    rows
}

/// The factors that some forms share, and each form divided by them.
fn taken_apart(model: &Model, angles: Option<&ComputedAngles>, forms: Vec<NormalForm>) -> (Vec<Factor>, Vec<Product>) {
    let (found, mut rest) = contents(model, angles, forms);
    let mut common: Vec<Factor> = found.into_iter().map(|(form, zeros)| Factor { form, zeros }).collect();
    let shared = shared_powers(&rest);
    if !shared.is_empty() {
        rest = rest.iter().map(|form| divided(form, &shared)).collect();
        let form = NormalForm::term(Harmonic::one(), shared, Number::one());
        common.push(Factor { form, zeros: Zeros::OfParameters });
    }
    let mut left: Vec<Product> = rest
        .iter()
        .map(|form| {
            let mut product = Product::of(Number::one());
            for factor in factors(model, angles, form) {
                match constant(&factor.form) {
                    Some(c) => product.coefficient = product.coefficient.times(c),
                    None => {
                        let (primitive, scale) = primitive(&factor.form);
                        product.coefficient = product.coefficient.times(&scale);
                        product.factors.push(primitive);
                    }
                }
            }
            product
        })
        .collect();
    // What several joints together decide is no content in one variable.
    for form in left[0].factors.clone() {
        let places: Option<Vec<usize>> = left.iter().map(|product| product.factors.iter().position(|own| *own == form)).collect();
        if let Some(places) = places {
            left.iter_mut().zip(places).for_each(|(product, at)| drop(product.factors.remove(at)));
            let zeros = zeros_without_joints(&form);
            common.push(Factor { form, zeros });
        }
    }
    if let (Some(first), Some(scale)) = (common.first_mut(), content(left.iter().map(|product| &product.coefficient))) {
        first.form = first.form.scaled(&Number::from(scale.clone()));
        let inverse = Number::from(Rational::ONE / scale);
        left.iter_mut().for_each(|product| product.coefficient = product.coefficient.times(&inverse));
    }
    (common, left)
}

/// The constant that a form is.
fn constant(form: &NormalForm) -> Option<&Number> {
    let mut terms = form.terms();
    let (harmonic, factors, c) = terms.next()?;
    (harmonic.angles.is_empty() && factors.is_empty() && terms.next().is_none()).then_some(c)
}

/// The powers of parameters that occur in every term.
fn shared_powers(forms: &[NormalForm]) -> Powers {
    let mut all = forms.iter().flat_map(NormalForm::terms).map(|(_, factors, _)| factors);
    let Some(first) = all.next() else { return Powers::new() };
    let mut shared: Powers = first.iter().filter(|(symbol, _)| matches!(symbol, Symbol::Parameter(_))).copied().collect();
    for factors in all {
        let power = |symbol: Symbol| factors.iter().find(|(own, _)| *own == symbol).map_or(0, |(_, power)| *power);
        shared.iter_mut().for_each(|(symbol, least)| *least = power(*symbol).min(*least));
        shared.retain(|(_, least)| *least > 0);
    }
    shared
}

/// A form divided by powers that occur in every term.
fn divided(form: &NormalForm, by: &Powers) -> NormalForm {
    let mut quotient = NormalForm::default();
    for (harmonic, factors, c) in form.terms() {
        let power = |symbol: Symbol| by.iter().find(|(own, _)| *own == symbol).map_or(0, |(_, power)| *power);
        let factors = factors.iter().map(|&(symbol, own)| (symbol, own - power(symbol))).filter(|(_, own)| *own > 0).collect();
        quotient.add_term(harmonic.clone(), factors, c.clone());
    }
    quotient
}

/// A form whose rational coefficients are integers without a common divisor, the first of them positive; and the factor that
/// makes it so.
fn primitive(form: &NormalForm) -> (NormalForm, Number) {
    let Some(scale) = content(form.terms().map(|(_, _, c)| c)) else { return (form.clone(), Number::one()) };
    let negative = form.by_harmonic().first().is_some_and(|(_, group)| group[0].1.leads_negative());
    let scale = if negative { -scale } else { scale };
    (form.scaled(&Number::from(Rational::ONE / &scale)), Number::from(scale))
}

/// The greatest positive fraction that divides all terms of some numbers; `None` without a term.
fn content<'a>(numbers: impl IntoIterator<Item = &'a Number>) -> Option<Rational> {
    let terms = numbers.into_iter().flat_map(|number| number.terms().map(|(_, coefficient)| coefficient));
    let parts = terms.map(|r| (r.numerator().clone().unsigned_abs(), r.denominator().clone()));
    let (numerator, denominator) = parts.reduce(|(a, b), (c, d)| {
        // The least common multiple of the denominators.
        let divisor = (&b).gcd(&d);
        ((&a).gcd(&c), b * d / divisor)
    })?;
    Some(Rational::from_parts(numerator.into(), denominator))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ring::normal_form::Arrangement;
    use crate::source::Source;
    use crate::validate;

    fn model(text: &str) -> Model {
        Model::new(validate::read(&Source::new("arm.yaml", text)).0.expect("valid").0)
    }

    /// The product of the shared factors and of what is left, squared and summed, is det(J J') of the Jacobian in the base frame.
    fn check_sum_of_squares(model: &Model, view: View<'_>) {
        let found = minors(model, view).expect("minors");
        let mut pool = Pool::new(model.field.clone());
        let of = |pool: &mut Pool, form: &NormalForm| pool.from_normal_form(form, Arrangement::ByHarmonic);
        let mut common = ExprId::ONE;
        for factor in &found.common {
            let factor = of(&mut pool, &factor.form);
            common = pool.mul(common, factor);
        }
        let mut sum = ExprId::ZERO;
        for (product, &value) in found.left.iter().zip(&found.values) {
            let mut minor = pool.constant(&product.coefficient);
            minor = pool.mul(minor, common);
            for form in &product.factors {
                let factor = of(&mut pool, form);
                minor = pool.mul(minor, factor);
            }
            assert_eq!(pool.fingerprint(minor), found.pool.fingerprint(value));
            let square = pool.mul(minor, minor);
            sum = pool.add(sum, square);
        }
        let arm = Arm::new(&mut pool, &model.manipulator, view);
        let jacobian = geometric_jacobian(&mut pool, &arm);
        let task: Vec<Vec<ExprId>> = model.manipulator.task.iter().map(|row| jacobian[row.index()].clone()).collect();
        let gram: Vec<Vec<ExprId>> = task.iter().map(|a| task.iter().map(|b| pool.dot(a, b)).collect()).collect();
        let determinant = of_columns(&mut pool, &gram)[(1 << gram.len()) - 1];
        assert_eq!(pool.fingerprint(sum), pool.fingerprint(determinant));
    }

    #[test]
    fn minors_are_those_of_the_jacobian_in_the_base_frame() {
        let planar = "name: planar\nconvention: standard\ngravity: [0, 0, -9.81]\nparameters: {l1: 2, l2: 3, l3: 1}\ntask: [x, y]\njoints:\n\
            \x20 - {name: a, type: revolute, a: l1, alpha: 0, d: 0, theta: 0, link: {mass: 1, inertia: {zz: 1}}}\n\
            \x20 - {name: b, type: revolute, a: l2, alpha: 0, d: 0, theta: pi/3, link: {mass: 1, inertia: {zz: 1}}}\n\
            \x20 - {name: c, type: revolute, a: l3, alpha: 0, d: 0, theta: 0, link: {mass: 1, inertia: {zz: 1}}}\n";
        for view in [View::Nominal, View::Symbolic] {
            check_sum_of_squares(&model(planar), view);
            check_sum_of_squares(&model(&planar.replace("b, type: revolute", "b, type: prismatic")), view);
        }
        let iiwa = include_str!("../../../../tests/data/iiwa14.yaml");
        for text in
            [iiwa, &format!("{iiwa}task: [rz, y, rx, x, z, ry]\n"), include_str!("../../../../tests/robots/base_set.yaml")]
        {
            check_sum_of_squares(&model(text), View::Nominal);
        }
    }

    #[test]
    fn long_minors_are_given_up_before_they_are_factored() {
        let everything = model(include_str!("../../../../tests/robots/everything.yaml"));
        assert!(matches!(minors(&everything, View::Nominal), Err(NoMinors::TooLong(common)) if common.is_empty()));
        let panda = model(include_str!("../../../../robots/panda7.yaml"));
        assert!(matches!(minors(&panda, View::Nominal), Err(NoMinors::TooLong(common)) if common.is_empty()));
    }
}
