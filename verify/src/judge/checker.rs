//! Functions of a module against the equations, at random points of all arithmetics.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use armgen_description::manipulator::{Manipulator, Tip};

use crate::certificate::report::{Exact, FunctionReport, Verdict, MOST_LOG2_ODDS};
use crate::judge::seed;
use crate::read::claims::{Claims, Resolved};
use crate::read::reader::{Function, Module};
use crate::textbook::base::{dependent_column, OwnParameters, Samples, FITTED};
use crate::textbook::equations::angles::Angles;
use crate::textbook::equations::arm::{formula, Arm};
use crate::textbook::equations::parameters::Vector;
use crate::textbook::equations::state::State;
use crate::textbook::reference::{BaseParameters, Reference, Values, Wanted, BASE_REGRESSOR};
use crate::values::arithmetic::degree::{log2_odds, Degree, Degrees};
use crate::values::arithmetic::prime::Prime;
use crate::values::arithmetic::roots::dependent;
use crate::values::arithmetic::tower::Tower;
use crate::values::arithmetic::Arithmetic;
use crate::values::check::{parallel_map, Check};
use crate::values::contract::{Promise, Sizes};
use crate::values::divisors::{is_needed, needed};
use crate::values::element::Element;
use crate::values::enclosure::Float;
use crate::values::formula::{Atoms, Dependent, Formula};
use crate::values::number::{Erased, Member, Number, Numbers};
use crate::values::program::{Limits, Program, Step};
use crate::values::signs;
use crate::values::stream::Stream;

/// The function that has a meaning up to a constant where parameters are base parameters.
const ENERGY_WITH: &str = "potential_energy_with";

const DIVIDED: &str = "a constant of the description divides by zero here";

/// How much is tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effort {
    /// Points in prime fields, each with a prime of its own: so many at least, more where the odds of a miss ask for them.
    pub points: usize,
    /// Rational points.
    pub exact_points: usize,
    /// Other points for other numbers; all else that they follow from is what is verified ([`mod@crate::judge::seed`]).
    pub seed: u64,
}

/// As many points in prime fields are tried at most.
const MOST_POINTS: usize = 32;

impl Default for Effort {
    fn default() -> Effort {
        Effort { points: 4, exact_points: 1, seed: 0 }
    }
}

/// A random point of an arithmetic with what every function must return there.
pub struct Point<K: Arithmetic> {
    /// The arithmetic.
    pub arithmetic: K,
    /// The point.
    pub reference: Reference<K::Element>,
    /// What `base_regressor` is judged by, if the module has one.
    base: Option<Samples<K::Element>>,
    constants: Mutex<BTreeMap<Formula, Option<K::Element>>>,
}

/// A point of either kind.
enum Drawn<M, E> {
    Modular(M),
    Exact(E),
}

impl<K: Arithmetic> Point<K> {
    /// Values of exact constants here; `None` if one divides by zero.
    pub fn literals(&self, formulas: &[Formula]) -> Option<Vec<K::Element>> {
        let mut known = self.constants.lock().unwrap_or_else(PoisonError::into_inner);
        formulas
            .iter()
            .map(|formula| match known.get(formula) {
                Some(value) => value.clone(),
                None => {
                    let value = self.arithmetic.constant(formula);
                    known.insert(formula.clone(), value.clone());
                    value
                }
            })
            .collect()
    }

    /// What a program runs with here, its literals having these values.
    pub fn literals_of(&self, program: &Program, values: &[Formula]) -> Option<Vec<K::Element>> {
        self.literals(&program.exact_literals(values))
    }

    /// The first entry of a program that is not what the equations say, and in which way; `None` if there is none.
    fn difference(&self, program: &Program, literals: &[Formula], base: bool) -> Option<(usize, &'static str)> {
        let expected = self.reference.values.get(&program.name)?;
        let Some(literals) = self.literals_of(program, literals) else {
            return Some((0, "has a constant that divides by 0 or is too long"));
        };
        let longest = |values: &[K::Element]| values.iter().map(Element::bits).max().unwrap_or(0);
        let of_all = self.reference.values.values().map(|values| longest(values)).max().unwrap_or(0);
        let limits = Limits::beside(longest(expected), of_all, expected.len());
        let values = program.run_within(limits, &self.reference.state, &literals);
        if let Some(entry) = values.iter().position(Option::is_none) {
            let before = values[..entry].iter().zip(expected).position(|(value, expected)| value.as_ref() != Some(expected));
            if before.is_none() || base && program.name == ENERGY_WITH {
                return Some((entry, program.without_value(&self.reference.state, &literals)));
            }
        }
        let entry = if base && program.name == ENERGY_WITH {
            self.energy_difference(program, &literals, &values)
        } else {
            values.iter().zip(expected).position(|(value, expected)| value.as_ref() != Some(expected))
        };
        entry.map(|entry| (entry, "differs from the equations"))
    }

    /// Whether there is something here to compare a function with.
    fn knows(&self, name: &str) -> bool {
        self.reference.values.contains_key(name) || name == BASE_REGRESSOR && self.base.is_some()
    }

    /// The first entry of a `base_regressor` that makes it none of these parameters.
    fn base_difference(&self, program: &Program, literals: &[Formula], base: &OwnParameters) -> Option<(String, String)> {
        let divided = || Some((String::new(), "a constant has no exact value".to_string()));
        let (Some(literals), Some(nominal)) = (self.literals_of(program, literals), self.literals(&base.nominal)) else {
            return divided();
        };
        self.base.as_ref()?.fault(program, &literals, &base.named, &nominal)
    }

    /// Whether a function may divide by the results of a program.
    fn may_divide(&self, function: &str, by: &Program, literals: &[Formula]) -> bool {
        let (Some((here, there, pivots_there)), Some(literals)) = (&self.reference.pivots, self.literals_of(by, literals)) else {
            return false;
        };
        let values = by.run(&self.reference.state, &literals).into_iter().zip(by.run(there, &literals));
        let mut divisors = values.map(|(a, b)| Some([a?, b?]));
        divisors.all(|values| values.is_some_and(|[a, b]| is_needed(function, [&a, &b], [here, pivots_there])))
    }

    /// The values that a function takes the signs of, results of a program, and the gravity torques that they may be; `None` where a value is none.
    fn signed(
        &self,
        function: &str,
        by: &Program,
        literals: &[Formula],
        loaded: &[usize],
    ) -> Option<(Vec<K::Element>, Vec<&K::Element>)> {
        let torques = signs::of_torques(function).and_then(|name| self.reference.values.get(name));
        let torques = loaded.iter().filter_map(|&joint| torques?.get(joint)).collect();
        let values = by.run(&self.reference.state, &self.literals_of(by, literals)?).into_iter().collect::<Option<_>>()?;
        Some((values, torques))
    }

    /// With base parameters the potential energy is defined up to a constant: its change between two configurations is compared.
    fn energy_difference(&self, program: &Program, literals: &[K::Element], here: &[Option<K::Element>]) -> Option<usize> {
        let (there, expected_there) = self.reference.elsewhere.as_ref()?;
        let expected_here = &self.reference.values.get(&program.name)?[0];
        let there = program.run(there, literals).first().cloned().flatten();
        let change = there.zip(here.first()?.as_ref()).map(|(there, here)| there.minus(here));
        (change != Some(expected_there.minus(expected_here))).then_some(0)
    }
}

/// Numbers of joints, parameters, base parameters and rows of the task.
fn sizes(manipulator: &Manipulator, vector: &Vector, base: Option<&OwnParameters>) -> Sizes {
    let parameters = match vector {
        Vector::Names(ids) => ids.len(),
        Vector::Standard(all) => all.len(),
        Vector::Base(base, _) => base.len(),
    };
    let base = base.map_or(0, |base| base.named.len());
    let gravity = manipulator.gravity_is_argument;
    let tips = manipulator.tips.iter().map(|tip| (tip.name.clone(), tip.task.len())).collect();
    let joints = manipulator.coupling.as_ref().map(|coupling| coupling.variables.len());
    Sizes { n: manipulator.dof(), joints, p: parameters, b: base, m: manipulator.task.len(), gravity, tips }
}

/// The program of a function that takes and gives what its name promises; else what is wrong.
fn fitting<'a>(
    sizes: &Sizes,
    (manipulator, real): (&Manipulator, Float),
    name: &str,
    function: &'a Function,
) -> Result<&'a Program, String> {
    let (promise, _) = Promise::of(name).ok_or("not a function that the checker knows the equations of")?;
    let program = &function.program;
    let places = promise.returned.places(&sizes.of_function(name));
    if program.outputs.iter().map(|o| &o.place).ne(&places) && Check::Places.is_made() {
        return Err(format!("its result does not have the {} entries that it should", places.len()));
    }
    match beyond_the_end(program, sizes) {
        Some(why) if Check::Indices.is_made() => return Err(why),
        _ => {}
    }
    match other_velocity(program, manipulator, real) {
        Some(why) if Check::Velocities.is_made() => Err(why),
        _ => Ok(program),
    }
}

/// An exponential at another velocity than that of the description: equations take exponentials as inputs, and cannot tell.
fn other_velocity(program: &Program, manipulator: &Manipulator, real: Float) -> Option<String> {
    program.steps.iter().find_map(|step| {
        let Step::Stribeck(joint, literal) = step else { return None };
        let Some(velocity) = manipulator.coordinates().get(*joint).and_then(|of| of.joint.decay_velocity()) else {
            return Some(format!("joint {} has no friction with an exponential", joint + 1));
        };
        let written = &program.literals[*literal];
        let other = !real.is_nearest(written.value, &formula(&velocity));
        other.then(|| {
            let given = velocity.to_f64();
            format!(
                "the exponential of the friction of joint {} decays at {}, in the description at {given}",
                joint + 1,
                written.text
            )
        })
    })
}

/// The equations of an arm at random points, ready for any module that claims to be its.
pub struct Checker {
    manipulator: Manipulator,
    vector: Vector,
    claims: Claims,
    points: Vec<Point<Prime>>,
    exact: Vec<Point<Erased<Tower>>>,
    /// log2 of the odds of a miss by function, for all points in prime fields together.
    log2_odds: BTreeMap<String, f64>,
    base: Option<OwnParameters>,
    sizes: Sizes,
    /// Random bits that nothing has been drawn from.
    rest: Stream,
}

/// Collects the constants of a description: an arithmetic whose numbers are of no interest.
struct Collector(RefCell<Vec<Formula>>);

impl Arithmetic for Collector {
    type Element = f64;
    fn integer(&self, value: i64) -> f64 {
        value as f64
    }
    fn constant(&self, formula: &Formula) -> Option<f64> {
        self.0.borrow_mut().push(formula.clone());
        Some(0.0)
    }
    fn draw(&mut self) -> f64 {
        0.0
    }
}

fn constants_of(manipulator: &Manipulator) -> Vec<Formula> {
    let collector = Collector(RefCell::default());
    let names = Arm::nominal(&collector, manipulator).unwrap_or_default();
    let _ = Arm::new(&collector, manipulator, &names);
    collector.0.into_inner()
}

/// What the constants of a description and the claimed ones are made of.
struct Constants {
    atoms: Atoms,
    dependent: Dependent,
}

impl Constants {
    fn of(manipulator: &Manipulator, claims: &Claims) -> Result<Constants, String> {
        let constants = constants_of(manipulator);
        // Angles by which the axes of a last link are turned bring the roots of their sines and cosines.
        let circles: Vec<Formula> =
            claims.formulas().map(|claim| claim.circle().1).filter(|cosine| !matches!(cosine, Formula::Cosine(_))).collect();
        let atoms = Atoms::of(constants.iter().chain(claims.formulas()).chain(&circles));
        let own = Atoms::of(constants.iter());
        if let Some(root) = atoms.roots.iter().find(|root| root.nested().is_some() && !own.roots.contains(root)) {
            let root = Formula::Root(root.clone());
            return Err(format!("a claimed constant has {root}, which the description does not have"));
        }
        let dependent = dependent(&atoms)?;
        Ok(Constants { atoms, dependent })
    }

    /// Roots that are independent.
    fn roots(&self) -> usize {
        self.atoms.roots.len() - self.dependent.len()
    }
}

impl Checker {
    /// Random points for an arm whose parameter vector is `vector`, as many as the functions of the module ask for; `base` for a module with a
    /// `base_regressor`.
    pub fn new(
        manipulator: Manipulator,
        vector: Vector,
        claims: Claims,
        effort: Effort,
        module: &Module,
        base: Option<OwnParameters>,
    ) -> Result<Checker, String> {
        let divides = module.programs().any(|(_, program)| !program.divisors().is_empty());
        let constants = Constants::of(&manipulator, &claims)?;
        let Constants { atoms, dependent } = &constants;
        let mut log2_odds = Odds::of_functions(&manipulator, &vector, &claims, &constants, module, base.as_ref());
        let worst = log2_odds.values().copied().filter(|odds| *odds < 0.0).fold(f64::NEG_INFINITY, f64::max);
        // A function of which nothing is known is refused whatever the number of points.
        let needed = (MOST_LOG2_ODDS / worst).ceil() as usize;
        let count = if effort.points == 0 { 0 } else { needed.min(MOST_POINTS).max(effort.points) };
        log2_odds.values_mut().for_each(|odds| *odds *= count as f64);
        let mut stream = seed::stream(&manipulator, module, &claims, effort.seed);
        let mut fields = Vec::new();
        for _ in 0..count {
            let field = Prime::new(&mut stream, atoms, dependent);
            fields.push(Drawn::Modular(field.ok_or("the constants have too many square roots for a prime field")?));
        }
        let joints = manipulator.joints.len();
        let exact_points = if Angles::of(&manipulator).have_rational_points() { effort.exact_points } else { 0 };
        fields.extend((0..exact_points).map_while(|_| Tower::new(&mut stream, atoms, dependent, joints)).map(Drawn::Exact));
        let modular = |mut field: Prime| {
            let wanted = Wanted { base: BaseParameters::Solved, pivots: divides };
            let reference = Reference::new(&mut field, &manipulator, &vector, wanted)?;
            let samples = match &base {
                Some(base) => Some(Samples::draw(&mut field, &manipulator, &base.named, &reference, FITTED).ok_or(DIVIDED)?),
                None => None,
            };
            Ok::<_, String>(Point { arithmetic: field, reference, base: samples, constants: Mutex::default() })
        };
        // Points in prime fields tell whether a constant divides by zero: here its number may be longer than any that is worth its time.
        let rational = |mut tower: Tower| {
            let wanted = Wanted { base: BaseParameters::Kept, pivots: false };
            let found = tower.within_limits(|tower| {
                let mut arithmetic = Erased(tower.clone());
                let mut numbers: Numbers<'_> = &mut arithmetic;
                let reference = Reference::new(&mut numbers, &manipulator, &vector, wanted).ok()?;
                let samples = base.as_ref().and_then(|_| Samples::torques(&reference));
                Some(Point { arithmetic, reference, base: samples, constants: Mutex::default() })
            });
            found.flatten()
        };
        let drawn = parallel_map(&fields, |field| match field {
            Drawn::Modular(field) => modular(field.clone()).map(|point| Some(Drawn::Modular(point))),
            Drawn::Exact(tower) => Ok(rational(tower.clone()).map(Drawn::Exact)),
        });
        let (mut points, mut exact) = (Vec::new(), Vec::new());
        for point in drawn {
            match point? {
                Some(Drawn::Modular(point)) => points.push(point),
                Some(Drawn::Exact(point)) => exact.push(point),
                None => {}
            }
        }
        let sizes = sizes(&manipulator, &vector, base.as_ref());
        Ok(Checker { manipulator, vector, claims, points, exact, log2_odds, base, sizes, rest: stream })
    }

    /// The arm.
    pub fn manipulator(&self) -> &Manipulator {
        &self.manipulator
    }

    /// What the parameter vector is.
    pub fn vector(&self) -> &Vector {
        &self.vector
    }

    /// The claimed constants.
    pub fn claims(&self) -> &Claims {
        &self.claims
    }

    /// The base parameters of its `base_regressor`.
    pub fn base(&self) -> Option<&OwnParameters> {
        self.base.as_ref()
    }

    /// Points in prime fields.
    pub fn points(&self) -> &[Point<Prime>] {
        &self.points
    }

    /// Random bits for other states, which follow from the module as the points do.
    pub fn rest(&self) -> Stream {
        self.rest.clone()
    }

    /// Number of entries of the parameter vector.
    pub fn parameters(&self) -> usize {
        self.sizes.p
    }

    /// Numbers of joints, parameters, base parameters and rows of the task.
    pub fn sizes(&self) -> Sizes {
        self.sizes.clone()
    }

    fn is_base(&self) -> bool {
        matches!(self.vector, Vector::Base(..))
    }

    /// Whether Lagrange's and Newton and Euler's equations agree at all points.
    pub fn derivations_agree(&self) -> bool {
        self.points.iter().all(|p| p.reference.two_derivations_agree)
            && self.exact.iter().all(|p| p.reference.two_derivations_agree)
    }

    /// All functions of a module, those that it lacks although they were asked for last.
    pub fn functions(&self, module: &Module) -> Vec<FunctionReport> {
        let mut reports: Vec<FunctionReport> =
            parallel_map(&module.functions, |(name, function)| self.function(name, function, module.real));
        let chosen = module.chosen();
        let asked_for = |name: &String| chosen.as_ref().is_none_or(|chosen| chosen.contains(name));
        let lacking = self.lacking(module).into_iter().filter(asked_for);
        reports.extend(lacking.map(|name| refused(&name, "the module does not have it".into())));
        reports
    }

    /// The functions that a module of all functions has, and this one lacks.
    pub fn lacking(&self, module: &Module) -> Vec<String> {
        // An optional one is missing where the arm has it.
        let of_arm = |name: &str| !self.points.is_empty() && self.points.iter().all(|point| point.knows(name));
        let needed = |name: &String| !self.manipulator.is_massless() || of_arm(name);
        let tips: Vec<String> = match self.manipulator.tips.as_slice() {
            [] => vec![String::new()],
            tips => tips.iter().map(Tip::prefix).collect(),
        };
        let required = Promise::required(&tips).into_iter().filter(|name| needed(name) && Check::Required.is_made());
        let optional = Promise::optional(&tips).filter(|name| of_arm(name) && Check::Optional.is_made());
        required.chain(optional).filter(|name| !module.functions.iter().any(|(other, _)| other == name)).collect()
    }

    /// One function.
    pub fn function(&self, name: &str, function: &Result<Function, String>, real: Float) -> FunctionReport {
        if name == BASE_REGRESSOR && self.base.is_none() {
            return refused(name, "the module does not say of which parameters: BASE_PARAMETER_NAMES".into());
        }
        let program = match function
            .as_ref()
            .map_err(String::clone)
            .and_then(|function| fitting(&self.sizes, (&self.manipulator, real), name, function))
        {
            Ok(program) => program,
            Err(why) => return refused(name, why),
        };
        if !self.points.iter().all(|point| point.knows(name)) {
            return refused(name, "there is no equation to compare it with for this robot".into());
        }
        self.compare(program, real)
    }

    fn compare(&self, program: &Program, real: Float) -> FunctionReport {
        let resolved = self.claims.resolve(&program.name, &program.literals, real);
        let (chosen, difference) = self.first_choice_that_holds(program, &resolved);
        let verdict = match difference {
            None => {
                (self.foreign_divisor(program, &chosen)).or_else(|| self.foreign_sign(program, &chosen)).unwrap_or(Verdict::Equal)
            }
            Some((entry, why)) => {
                let suspect = self.claims.suspect(program, &entry, real);
                Verdict::Different { entry, why: why + &suspect.map_or_else(String::new, |suspect| format!("; {suspect}")) }
            }
        };
        let literals = program.literals.iter().zip(&chosen);
        FunctionReport {
            name: program.name.clone(),
            verdict,
            points: self.points.len(),
            exact_points: self.exact_points(program, &chosen).count(),
            log2_odds: self.log2_odds.get(&program.name).copied().unwrap_or(0.0),
            literals: literals.map(|(l, value)| Exact { literal: l.text.clone(), value: value.clone() }).collect(),
            bound: None,
            unfit: None,
        }
    }

    /// The rational points at which a function and all its constants have values.
    fn exact_points<'a>(
        &'a self,
        program: &'a Program,
        literals: &'a [Formula],
    ) -> impl Iterator<Item = (usize, &'a Point<Erased<Tower>>)> {
        let nominal = self.base.as_ref().filter(|_| program.name == BASE_REGRESSOR).map_or(&[][..], |base| &base.nominal);
        let has_values = |point: &Point<_>| point.literals_of(program, literals).is_some() && point.literals(nominal).is_some();
        self.exact.iter().enumerate().filter(move |(_, point)| point.knows(&program.name) && has_values(point))
    }

    /// Where several constants round to the same literal, the choice that equals the equations; else the first.
    fn first_choice_that_holds(&self, program: &Program, resolved: &Resolved) -> (Vec<Formula>, Option<(String, String)>) {
        let Some(difference) = self.difference(program, &resolved.values) else { return (resolved.values.clone(), None) };
        match resolved.choices().into_iter().skip(1).find(|choice| self.difference(program, choice).is_none()) {
            Some(choice) => (choice, None),
            None => (resolved.values.clone(), Some(difference)),
        }
    }

    fn difference(&self, program: &Program, literals: &[Formula]) -> Option<(String, String)> {
        if program.name == BASE_REGRESSOR {
            return self.base_difference(program, literals);
        }
        let base = self.is_base();
        let modular = self.points.iter().enumerate().filter_map(|(i, point)| {
            point
                .difference(program, literals, base)
                .map(|(entry, how)| (entry, format!("{how} at point {} modulo {}", i + 1, point.arithmetic.prime())))
        });
        let exact = self.exact_points(program, literals).filter_map(|(i, point)| {
            point.difference(program, literals, base).map(|(entry, how)| (entry, format!("{how} at rational point {}", i + 1)))
        });
        let modular = modular.filter(|_| Check::Modular.is_made());
        let exact = exact.filter(|_| Check::Rational.is_made());
        let (entry, why) = modular.chain(exact).min_by_key(|(entry, _)| *entry)?;
        Some((program.outputs[entry].place.clone(), why))
    }

    fn base_difference(&self, program: &Program, literals: &[Formula]) -> Option<(String, String)> {
        let base = self.base.as_ref()?;
        let modular = self.points.iter().enumerate().find_map(|(i, point)| {
            let (entry, why) = point.base_difference(program, literals, base)?;
            Some((entry, format!("{why}, at point {} modulo {}", i + 1, point.arithmetic.prime())))
        });
        let exact = || {
            self.exact_points(program, literals).find_map(|(i, point)| {
                let (entry, why) = point.base_difference(program, literals, base)?;
                Some((entry, format!("{why}, at rational point {}", i + 1)))
            })
        };
        // A rank is proved by one point.
        let dependent = || {
            let point = self.points.first()?;
            let literals = point.literals_of(program, literals)?;
            dependent_column(point.arithmetic.clone(), program, &literals, &Angles::of(&self.manipulator), base.named.len())
        };
        let modular = modular.filter(|_| Check::Modular.is_made());
        let exact = || exact().filter(|_| Check::Rational.is_made());
        let dependent = || dependent().filter(|_| Check::Columns.is_made());
        modular.or_else(exact).or_else(dependent)
    }

    /// The sign of something that the equations do not take the sign of, or of one torque in two forms.
    fn foreign_sign(&self, program: &Program, chosen: &[Formula]) -> Option<Verdict> {
        let operands = signs::operands(program);
        if operands.is_empty() {
            return None;
        }
        let by = program.part(&operands);
        let coordinates = self.manipulator.coordinates();
        let loaded: Vec<usize> = (0..self.sizes.n).filter(|&a| coordinates[a].joint.load.is_some()).collect();
        let points = self.points.iter().map(|point| point.signed(&program.name, &by, chosen, &loaded));
        let Some(points) = points.collect::<Option<Vec<_>>>() else {
            return Some(Verdict::Refused("it takes the sign of what has no value".into()));
        };
        let refused = |why: &str| Some(Verdict::Refused(why.into()));
        if Check::LoadSigns.is_made() && !points.iter().all(|(values, torques)| signs::are_torques(values, torques)) {
            return refused("it takes the sign of what is no gravity torque that friction of a joint grows with");
        }
        if Check::SignsOnce.is_made() && points.iter().all(|(values, _)| signs::are_equal(values)) && !points.is_empty() {
            return refused("it takes the sign of one torque in two forms, which differ where it is small");
        }
        None
    }

    /// A divisor that the equations do not ask for.
    fn foreign_divisor(&self, program: &Program, chosen: &[Formula]) -> Option<Verdict> {
        let divisors = program.divisors();
        let by = program.part(&divisors);
        if !Check::Divisors.is_made()
            || divisors.is_empty()
            || self.points.iter().all(|point| point.may_divide(&program.name, &by, chosen))
        {
            return None;
        }
        Some(Verdict::Refused(if needed(&program.name).is_empty() {
            "it divides, which its equations do not ask for".into()
        } else {
            "it divides by what is no pivot of a matrix that its equations invert".into()
        }))
    }
}

/// Degrees and heights of what the equations say, for the odds of a miss.
struct Odds {
    degrees: Degrees,
    state: State<Degree>,
    values: Values<Degree>,
    /// The named parameters of a `base_regressor` and their values.
    base: Option<(Samples<Degree>, OwnParameters, Vec<Degree>)>,
    circles: usize,
    roots: usize,
}

impl Odds {
    /// log2 of the odds, for one point, by function.
    fn of_functions<'a>(
        manipulator: &Manipulator,
        vector: &Vector,
        claims: &Claims,
        constants: &Constants,
        module: &'a Module,
        base: Option<&OwnParameters>,
    ) -> BTreeMap<String, f64> {
        let sizes = sizes(manipulator, vector, base);
        let fitting = |(name, function): &'a (String, Result<Function, String>)| {
            fitting(&sizes, (manipulator, module.real), name, function.as_ref().ok()?).ok()
        };
        let literals: Vec<(&Program, Vec<Formula>)> = (module.functions.iter().filter_map(fitting))
            .map(|program| {
                let values = claims.resolve(&program.name, &program.literals, module.real).values.clone();
                (program, program.exact_literals(&values))
            })
            .collect();
        let own = constants_of(manipulator);
        let nominal = base.iter().flat_map(|base| &base.nominal);
        let mut degrees = Degrees::new(own.iter().chain(literals.iter().flat_map(|(_, values)| values)).chain(nominal));
        let wanted = Wanted { base: BaseParameters::Free, pivots: false };
        let mut erased = Erased(&mut degrees);
        let mut numbers: Numbers<'_> = &mut erased;
        let Ok(reference) = Reference::new(&mut numbers, manipulator, vector, wanted) else { return BTreeMap::new() };
        let samples = base.and_then(|own| Samples::draw(&mut numbers, manipulator, &own.named, &reference, 0));
        let base = base.zip(samples).and_then(|(own, samples)| {
            let nominal = own.nominal.iter().map(|value| degrees.constant(value)).collect::<Option<Vec<_>>>()?;
            Some((samples.map(&Degree::of), own.clone(), nominal))
        });
        let circles = Angles::of(manipulator).circles() + constants.atoms.angles.len();
        let state = reference.state.map(&Degree::of);
        let of_entries = |(name, entries): (String, Vec<Number>)| (name, entries.into_iter().map(Degree::of).collect());
        let values = reference.values.into_iter().map(of_entries).collect();
        let odds = Odds { degrees, state, values, base, circles, roots: constants.roots() };
        literals.iter().map(|(program, values)| (program.name.clone(), odds.of(program, values))).collect()
    }

    /// log2 of the odds that a program of this degree passes one point although it differs.
    fn of(&self, program: &Program, literals: &[Formula]) -> f64 {
        let literals = literals.iter().map(|value| self.degrees.constant(value)).collect::<Option<Vec<_>>>();
        let Some(literals) = literals else { return 0.0 };
        let odds = |degree: f64, height: f64| log2_odds(degree, height, self.circles, self.roots);
        if let (BASE_REGRESSOR, Some((samples, own, nominal))) = (program.name.as_str(), &self.base) {
            return samples.log2_odds(program, &literals, (&own.named, nominal), odds).min(0.0);
        }
        let outputs = program.run(&self.state, &literals);
        let Some(expected) = self.values.get(&program.name) else { return 0.0 };
        let of_entry = |(output, expected): (&Option<Degree>, &Degree)| match output {
            Some(output) => {
                let (degree, height) = output.of_difference(expected);
                odds(degree, height)
            }
            None => 0.0,
        };
        outputs.iter().zip(expected).map(of_entry).fold(f64::NEG_INFINITY, f64::max).min(0.0)
    }
}

fn refused(name: &str, why: String) -> FunctionReport {
    let verdict = Verdict::Refused(why);
    FunctionReport {
        name: name.into(),
        verdict,
        points: 0,
        exact_points: 0,
        log2_odds: 0.0,
        literals: Vec::new(),
        bound: None,
        unfit: None,
    }
}

/// An index that its argument does not have: the reader knows arguments by name only.
fn beyond_the_end(program: &Program, sizes: &Sizes) -> Option<String> {
    let n = sizes.n;
    program.steps.iter().find_map(|step| match step {
        Step::Input(argument, index) if *index >= argument.length().of(sizes) => {
            Some(format!("index {index} is beyond the end of its argument"))
        }
        Step::Sign(joint) | Step::Stribeck(joint, _) if *joint >= n => Some(format!("index {joint} is beyond the end of `dq`")),
        Step::Sine(angle) | Step::Cosine(angle) => {
            angle.terms.iter().find(|(joint, _)| *joint >= n).map(|(joint, _)| format!("index {joint} is beyond the end of `q`"))
        }
        _ => None,
    })
}

/// A state of any arithmetic with parameters put in.
pub fn with_parameters<E: Element>(state: &State<E>, pi: Vec<E>) -> State<E> {
    State { pi, ..state.clone() }
}
