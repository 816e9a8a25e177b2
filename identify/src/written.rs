//! An identified arm in the text of its description: new numbers with their intervals, and the proof that the written bodies are possible.
//!
//! ```text
//! m > 0 and S = ½ tr(I) 1 - I positive definite, I about the centre of mass   <=>   [[S + m c c', m c], [m c', m]] positive definite
//! ```
//!
//! The written text is read again, and the leading minors of diag(m, S) are exact numbers of its decimals. Their quotients are the pivots of
//! LDL'. The axes of I do not matter.

use armgen_codegen::derive::parameters::nominal;
use armgen_codegen::description::{Dimension, RobotDescription, Value, INERTIA_ELEMENTS};
use armgen_codegen::diagnostic::{Code as Fault, Colour, Severity};
use armgen_codegen::document::edit::{edit, Change, Step};
use armgen_codegen::document::{excerpt, Expression, ExpressionKind, Unit};
use armgen_codegen::exact::{Number, Polynomial, Rational};
use armgen_codegen::manipulator::{Body, Manipulator};
use armgen_codegen::source::{Source, Span};
use armgen_codegen::validate;
use nalgebra::{DVector, Vector3};

use crate::arm::Arm;
use crate::baseline::Baseline;
use crate::body::{self, Ten};
use crate::consistent::Consistent;
use crate::identify::{Identified, Interval};
use crate::prepare::Friction;

/// The word that begins our comments.
pub const MARK: &str = "identified";

/// Digits of the numbers of bodies: so many at least, and at most.
const DIGITS: std::ops::RangeInclusive<usize> = 4..=12;

/// Rounding moves no parameter by more than this part of its standard error.
const MOVED: f64 = 0.01;

/// A description with identified numbers.
#[derive(Clone, Debug, Default)]
pub struct Written {
    /// Its text.
    pub text: String,
    /// Significant digits of the largest number of a mass, a centre of mass or an inertia.
    pub digits: usize,
    /// Numbers that changed.
    pub changed: usize,
    /// The parameters as they are written.
    pub consistent: Consistent,
    /// Friction by joint, in the order of [`Friction::ALL`].
    pub friction: Vec<[f64; 6]>,
    /// Velocities of Stribeck friction.
    pub velocities: Vec<f64>,
    /// The pivots of LDL' of diag(m, S) of each link, rounded; the exact ones are positive.
    pub pivots: Vec<[f64; 4]>,
    /// What was done beside the replacement of numbers.
    pub notes: Vec<String>,
}

/// A number with the power of ten that it is a multiple of.
fn decimal(x: f64, power: i32) -> String {
    let x = if power > 0 { (x / 10f64.powi(power)).round() * 10f64.powi(power) } else { x };
    let size = x.abs().log10().floor();
    if x == 0.0 || size < f64::from(power) - 1.0 {
        return "0".to_owned();
    }
    let fixed = format!("{x:.*}", usize::try_from(-power).unwrap_or(0));
    if fixed.trim_matches(['-', '0', '.']).is_empty() {
        return "0".to_owned();
    }
    if size < -4.0 {
        let digits = usize::try_from(size as i32 - power).unwrap_or(0);
        let text = format!("{x:.digits$e}");
        let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
        return format!("{}e{exponent}", trimmed(mantissa));
    }
    trimmed(&fixed).to_owned()
}

fn trimmed(decimal: &str) -> &str {
    if decimal.contains('.') {
        decimal.trim_end_matches('0').trim_end_matches('.')
    } else {
        decimal
    }
}

/// The power of ten of a digit: `digits` significant ones of a size.
fn power(size: f64, digits: usize) -> i32 {
    if size > 0.0 {
        size.log10().floor() as i32 + 1 - digits as i32
    } else {
        0
    }
}

/// The power of ten that rounding moves by less than a hundredth of sigma, with no more than twelve digits.
fn power_of_sigma(value: f64, sigma: f64) -> i32 {
    let most = power(value.abs(), *DIGITS.end());
    if sigma > 0.0 {
        ((2.0 * MOVED * sigma).log10().floor() as i32).max(most)
    } else {
        most
    }
}

/// A value of the description, and what it becomes.
struct Target<'d> {
    path: Vec<Step>,
    given: Option<&'d Expression>,
    old: Option<f64>,
    new: f64,
    /// What the comment says, without the old value.
    remark: String,
    /// The power of ten that it is a multiple of, in units of the file.
    power: i32,
    unit: f64,
}

struct Plan<'d> {
    /// Digits beyond those that standard errors ask for.
    finer: usize,
    source: &'d Source,
    description: &'d RobotDescription,
    changes: Vec<Change>,
    notes: Vec<(Span, String)>,
}

fn key(name: &str) -> Step {
    Step::Key(name.to_owned())
}

impl Plan<'_> {
    fn unit(&self, dimension: Dimension) -> f64 {
        self.description.unit(dimension).map_or(1.0, |unit: Unit| unit.to_f64())
    }

    /// Plans a value; what it is as written.
    fn set(&mut self, target: Target<'_>) -> f64 {
        let text = decimal(target.new / target.unit, target.power);
        let old = target.old.unwrap_or(0.0);
        if decimal(old / target.unit, target.power) == text {
            return old;
        }
        let written = text.parse::<f64>().unwrap_or(target.new / target.unit) * target.unit;
        let slice = |span: Span| excerpt(self.source.slice(span).trim_matches(['"', '\'']));
        let bare = target.given.map(|given| match &given.kind {
            ExpressionKind::InUnit(inner, _) => inner,
            _ => given,
        });
        let mut path = target.path;
        let mut was = target.given.map_or_else(|| "; new".to_owned(), |given| format!("; was {}", slice(given.span)));
        if let Some(ExpressionKind::Name(name)) = bare.map(|bare| &bare.kind) {
            let definition = self.description.parameters.iter().find(|parameter| parameter.name.value == *name);
            if let Some(value) = definition.filter(|_| self.description.uses(name) == 1).and_then(|of| of.value.as_ref()) {
                was = format!("; was {}", slice(value.span));
                path = vec![key("parameters"), key(name)];
            } else if let Some(given) = target.given {
                self.notes.push((given.span, format!("`{name}` is used elsewhere too: a number takes its place here")));
            }
        } else if let Some(given) = bare.filter(|bare| !bare.is_decimal()) {
            self.notes.push((given.span, format!("a number takes the place of `{}`", slice(given.span))));
        }
        self.changes.push(Change { path, value: text, remark: format!("{}{was}", target.remark) });
        written
    }
}

/// An interval in words, in a unit.
fn range(of: &Interval, unit: f64) -> String {
    if !of.excited {
        return "not shown by the logs".to_owned();
    }
    let power = power_of_sigma(of.value / unit, 10.0 * of.sigma / unit);
    format!("{} to {} (3 sigma)", decimal(of.low / unit, power), decimal(of.high / unit, power))
}

/// Base parameters that a standard parameter is part of, in words.
fn seen_in(arm: &Arm, found: &Identified, columns: &[usize], unit: f64) -> String {
    let rows: Vec<usize> =
        (0..arm.base.len()).filter(|&row| columns.iter().any(|&column| arm.combination[(row, column)] != 0.0)).collect();
    if let ([row], [column]) = (rows.as_slice(), columns) {
        let alone = arm.combination.row(*row).iter().filter(|t| **t != 0.0).count() == 1;
        let is_mass = *column % 10 == 0 || *column >= 10 * arm.dof();
        if alone && is_mass {
            return range(&found.base[*row], unit * arm.combination[(*row, *column)]);
        }
    }
    if rows.is_empty() {
        return "shown by no motion".to_owned();
    }
    let names: Vec<&str> = rows.iter().take(3).map(|&row| arm.base[row].name.as_str()).collect();
    format!("in sum with others, see {}{}", names.join(" "), if rows.len() > 3 { " ..." } else { "" })
}

/// Mass, centre of mass, and inertia about it in axes.
fn given_of(ten: &Ten, axes: &nalgebra::Matrix3<f64>) -> [f64; 10] {
    let (mass, com, tensor) = body::about_com(ten);
    let e = body::elements(&(axes.transpose() * tensor * axes));
    [mass, com[0], com[1], com[2], e[0], e[1], e[2], e[3], e[4], e[5]]
}

fn ten_of(given: &[f64; 10], axes: &nalgebra::Matrix3<f64>) -> Ten {
    let tensor = axes * body::symmetric(&given[4..]) * axes.transpose();
    body::ten(given[0], Vector3::new(given[1], given[2], given[3]), &tensor)
}

/// Plans all values with so many digits, and what they are as written.
fn plan<'d>(
    plan: &mut Plan<'d>,
    description: &'d RobotDescription,
    arm: &Arm,
    found: &Identified,
    consistent: &Consistent,
    digits: usize,
) -> Written {
    let joints = description.joints.as_ref().map_or(&[][..], |joints| &joints.value);
    let mut written = Written {
        digits,
        consistent: consistent.clone(),
        friction: vec![[0.0; 6]; arm.dof()],
        velocities: found.velocities.clone(),
        ..Written::default()
    };
    for (i, (joint, link)) in joints.iter().zip(&arm.links).enumerate() {
        let of_joint = |rest: &[Step]| [&[key("joints"), Step::Item(i)], rest].concat();
        let given = joint.link.as_ref();
        let new = given_of(&consistent.bodies[i], &link.axes);
        let mut as_written = new;
        let turned = link.axes != nalgebra::Matrix3::identity();
        let com: Option<&[Value; 3]> = given.and_then(|link| link.com.as_ref()).map(|com| &com.value);
        let inertia = given.and_then(|link| link.inertia.as_ref()).map(|inertia| &inertia.elements);
        let size = |range: std::ops::Range<usize>| new[range].iter().fold(0.0f64, |size, x| size.max(x.abs()));
        for k in 0..10 {
            let (path, value, dimension, size) = match k {
                0 => (vec![key("mass")], given.and_then(|link| link.mass.as_ref()), Dimension::Mass, new[0]),
                1..=3 => {
                    let path = vec![key("com"), Step::Item(k - 1)];
                    (path, com.and_then(|com| com[k - 1].as_ref()), Dimension::Length, size(1..4))
                }
                _ => {
                    let path = vec![key("inertia"), key(INERTIA_ELEMENTS[k - 4])];
                    let is_product = matches!(k, 5 | 7 | 8);
                    let dimension = if is_product { Dimension::ProductOfInertia } else { Dimension::Inertia };
                    (path, inertia.and_then(|elements| elements[k - 4].as_ref()), dimension, size(4..10))
                }
            };
            let unit = plan.unit(dimension);
            let columns: Vec<usize> = if turned && k > 3 { (10 * i + 4..10 * i + 10).collect() } else { vec![10 * i + k] };
            let remark = seen_in(arm, found, &columns, unit);
            let power = power(size / unit.abs(), digits);
            let path = of_joint(&[&[key("link")], path.as_slice()].concat());
            // A list has all its elements.
            let list_is_new = (1..=3).contains(&k) && com.is_none() && (1..4).any(|k| decimal(new[k] / unit, power) != "0");
            if list_is_new {
                let text = decimal(new[k] / unit, power);
                as_written[k] = text.parse::<f64>().unwrap_or(0.0) * unit;
                plan.changes.push(Change { path, value: text, remark: format!("{remark}; new") });
                continue;
            }
            as_written[k] = plan.set(Target { path, given: value, old: Some(link.given[k]), new: new[k], remark, power, unit });
        }
        written.consistent.bodies[i] = ten_of(&as_written, &link.axes);
        if link.attachments > 0 && joint.link.is_some() {
            plan.notes.push((joint.span, "bodies under `attached` are known: they keep their numbers".to_owned()));
        }
        let motor = joint.motor.as_ref();
        if let Some(rotor) = arm.rotors.iter().position(|of| *of == i) {
            let unit = plan.unit(Dimension::RotorInertia);
            let new = consistent.rotors[rotor];
            written.consistent.rotors[rotor] = plan.set(Target {
                path: of_joint(&[key("motor"), key("inertia")]),
                given: motor.and_then(|motor| motor.inertia.as_ref()),
                old: Some(arm.joints[i].rotor),
                new,
                remark: seen_in(arm, found, &[10 * arm.dof() + rotor], unit),
                power: power(new / unit, digits),
                unit,
            });
        }
        if let Some(gain) = found.gains.get(i).filter(|gain| gain.excited && motor.is_some()) {
            plan.set(Target {
                path: of_joint(&[key("motor"), key("gain")]),
                given: motor.and_then(|motor| motor.gain.as_ref()),
                old: arm.joints[i].gain,
                new: gain.value,
                remark: range(gain, 1.0),
                power: power_of_sigma(gain.value, gain.sigma),
                unit: 1.0,
            });
        }
        friction(plan, description, arm, found, consistent, i, &mut written);
    }
    written
}

fn friction<'d>(
    plan: &mut Plan<'d>,
    description: &'d RobotDescription,
    arm: &Arm,
    found: &Identified,
    consistent: &Consistent,
    i: usize,
    written: &mut Written,
) {
    let Some(joint) = description.joints.as_ref().and_then(|joints| joints.value.get(i)) else { return };
    let of_friction = |rest: &[Step]| [&[key("joints"), Step::Item(i), key("friction")], rest].concat();
    let slides = arm.joints[i].slides;
    let torque = plan.unit(if slides { Dimension::Force } else { Dimension::Torque });
    let stribeck = joint.friction.stribeck.as_ref();
    for term in Friction::ALL {
        let (given, unit) = match term {
            Friction::Viscous => (&joint.friction.viscous, torque),
            Friction::Coulomb => (&joint.friction.coulomb, torque),
            Friction::Offset => (&joint.friction.offset, torque),
            Friction::Load => (&joint.friction.load, 1.0),
            Friction::Cubic => (&joint.friction.cubic, torque),
            Friction::Stribeck => (stribeck.map_or(&None, |stribeck| &stribeck.torque), torque),
        };
        let is_new = found.friction.iter().find(|of| of.session + 1 == found.sessions.len() && (of.joint, of.term) == (i, term));
        let held = found.held.iter().find(|(joint, of, _)| (*joint, *of) == (i, term)).map(|(.., value)| *value);
        let place = found.reduced.friction.iter().position(|of| *of == (i, term));
        let (new, sigma, remark) = match (is_new, place, held) {
            (Some(of), Some(place), _) => {
                let value = consistent.friction[place];
                let value = if term.is_not_negative() && value < MOVED * of.value.sigma { 0.0 } else { value };
                (value, of.value.sigma, range(&of.value, unit))
            }
            (_, _, Some(value)) => (value, 0.0, "given by the options".to_owned()),
            _ => (0.0, 0.0, "not found in the logs".to_owned()),
        };
        let path = if term == Friction::Stribeck { vec![key("stribeck"), key("torque")] } else { vec![key(term.key())] };
        written.friction[i][term as usize] = plan.set(Target {
            path: of_friction(&path),
            given: given.as_ref(),
            old: arm.joints[i].friction[term as usize],
            new,
            remark,
            // A term that vanishes must not be rounded to the digits of 0.
            power: power_of_sigma(
                new.abs().max(arm.joints[i].friction[term as usize].unwrap_or(0.0).abs()) / unit,
                sigma / unit * 10f64.powi(-(plan.finer as i32)),
            ),
            unit,
        });
    }
    if written.friction[i][Friction::Stribeck as usize] != 0.0 && is_found(found, i) {
        let unit = plan.unit(if slides { Dimension::Velocity } else { Dimension::AngularVelocity });
        let new = found.velocities[i];
        written.velocities[i] = plan.set(Target {
            path: of_friction(&[key("stribeck"), key("velocity")]),
            given: stribeck.and_then(|stribeck| stribeck.velocity.as_ref()),
            old: stribeck.map(|_| arm.joints[i].stribeck_velocity),
            new,
            remark: "of the least residual".to_owned(),
            power: power(new / unit, 4),
            unit,
        });
    }
}

fn is_found(found: &Identified, joint: usize) -> bool {
    found.reduced.friction.contains(&(joint, Friction::Stribeck))
}

/// The leading minors of diag(m, S), exactly, where all are positive. Their quotients are the pivots of LDL'; roots stay exact, since nothing
/// is divided.
pub(crate) fn minors(manipulator: &Manipulator, given: &Body) -> Option<[Number; 4]> {
    let of = |value: &Polynomial| nominal(manipulator, value);
    let [xx, xy, yy, xz, yz, zz] = given.inertia.each_ref().map(of);
    let half = Number::from(Rational::from_parts(1.into(), 2u8.into()));
    let trace = &(&(&xx + &yy) + &zz) * &half;
    // S = ½ tr(I) 1 - I.
    let [a, b, c] = [&trace - &xx, &trace - &yy, &trace - &zz];
    let (d, e, f) = (-&xy, -&xz, -&yz);
    let two = &(&a * &b) - &(&d * &d);
    let first = &a * &(&(&b * &c) - &(&f * &f));
    let second = &d * &(&(&d * &c) - &(&f * &e));
    let third = &e * &(&(&d * &f) - &(&b * &e));
    let three = &(&first - &second) + &third;
    let minors = [of(&given.mass), a, two, three];
    minors.iter().all(|minor| minor.sign() == std::cmp::Ordering::Greater).then_some(minors)
}

/// The pivots of each link's own body; the link whose body is not positive definite.
fn pivots(manipulator: &Manipulator) -> Result<Vec<[f64; 4]>, usize> {
    let links = manipulator.joints.iter().enumerate();
    links
        .map(|(i, joint)| {
            let minors = joint.link.first().and_then(|body| minors(manipulator, &body.given)).ok_or(i)?;
            let [mass, a, two, three] = minors.map(|minor| minor.to_f64());
            Ok([mass, a, two / a, three / two])
        })
        .collect()
}

/// The text of a description with identified numbers.
///
/// # Errors
///
/// The reason why the text cannot have them, with its place.
pub fn write(source: &Source, arm: &Arm, found: &Identified, consistent: &Consistent) -> Result<Written, String> {
    write_finer(source, arm, found, consistent, 0)
}

/// The same with so many more digits than rounding far below the standard errors asks for.
///
/// # Errors
///
/// The reason why the text cannot have them, with its place.
pub fn write_finer(
    source: &Source,
    arm: &Arm,
    found: &Identified,
    consistent: &Consistent,
    finer: usize,
) -> Result<Written, String> {
    let at = |span: Span, text: &str| format!("{}:{}: {text}", source.name(), source.place(span.start));
    let (description, _) = RobotDescription::parse(source);
    let description = description.ok_or_else(|| at(Span::default(), "no description"))?;
    let exact = consistent.base(arm);
    let mut reason = String::new();
    let mut more = finer;
    for digits in DIGITS {
        let mut planned = Plan { finer, source, description: &description, changes: Vec::new(), notes: Vec::new() };
        let mut written = plan(&mut planned, &description, arm, found, consistent, digits);
        let base = written.consistent.base(arm);
        let moved = |k: usize| (base[k] - exact[k]).abs() > (MOVED * found.base[k].sigma).max(1e-10 * exact.amax());
        if digits < *DIGITS.end() && (0..base.len()).any(moved) {
            continue;
        }
        if digits < *DIGITS.end() && more > 0 {
            more -= 1;
            continue;
        }
        // Values with the same path: a name that several joints share is no single use, so there are none.
        let edited = edit(source, MARK, &planned.changes).map_err(|(span, text)| at(span, &text))?;
        let baseline =
            Baseline { delays: found.delays.iter().map(|delay| delay.value).collect(), spreads: found.spreads.clone() };
        let text = baseline.written(arm, &edited.text);
        let again = Source::new(source.name(), text.as_str());
        let (read, diagnostics) = validate::read(&again);
        let Some((manipulator, _)) = read.filter(|_| !diagnostics.has_errors()) else {
            let text = diagnostics.render(&again, Colour::Never);
            let mut errors = diagnostics.iter().filter(|of| of.code.severity() == Severity::Error);
            if errors.all(|of| of.code == Fault::ImpossibleInertia) {
                reason = format!("rounded to {digits} digits, no bodies have these inertias:\n{text}");
                continue;
            }
            return Err(format!("with the new numbers the description is faulty, so nothing is written:\n{text}"));
        };
        reread(&manipulator, arm, &written)?;
        match pivots(&manipulator) {
            Ok(pivots) => {
                let line = |(span, text): &(Span, String)| at(*span, text);
                written.notes = planned.notes.iter().chain(&edited.notes).map(line).collect();
                written.notes.dedup();
                (written.text, written.changed, written.pivots) = (text, planned.changes.len(), pivots);
                return Ok(written);
            }
            Err(link) => {
                reason = format!("rounded to {digits} digits, no body has the inertia of joint `{}`", arm.joints[link].name)
            }
        }
    }
    Err(reason)
}

/// Whether the arm that is read again has the numbers that were to be written.
fn reread(manipulator: &Manipulator, arm: &Arm, written: &Written) -> Result<(), String> {
    for (i, joint) in manipulator.joints.iter().enumerate() {
        let of = |value: &Polynomial| nominal(manipulator, value).to_f64();
        let optional = |value: &Option<Polynomial>| value.as_ref().map_or(0.0, of);
        let body = joint.link.first().map(|body| &body.body);
        let body = body.map_or([0.0; 10], |body| {
            let inertia: Vec<f64> = body.inertia.iter().map(of).collect();
            body::ten(of(&body.mass), Vector3::from_iterator(body.com.iter().map(of)), &body::symmetric(&inertia))
        });
        let stribeck = joint.stribeck.as_ref().map_or(0.0, |stribeck| of(&stribeck.torque));
        let load = joint.load.as_ref().map_or(0.0, Number::to_f64);
        let friction =
            [optional(&joint.viscous), optional(&joint.coulomb), optional(&joint.offset), load, optional(&joint.cubic), stribeck];
        let rotor = arm.rotors.iter().position(|of| *of == i);
        let inertia = joint.motor.as_ref().map_or(0.0, |motor| optional(&motor.inertia));
        let meant = written.consistent.bodies[i].iter().chain(&written.friction[i]);
        let meant: Vec<f64> = meant.copied().chain(rotor.map(|rotor| written.consistent.rotors[rotor])).collect();
        let found: Vec<f64> = body.iter().chain(&friction).copied().chain(rotor.map(|_| inertia)).collect();
        let size = DVector::from_vec(meant.clone()).rows(0, 10).amax();
        let far = meant.iter().zip(&found).enumerate().any(|(k, (meant, found))| {
            let size = if k < 10 { size } else { meant.abs() };
            (meant - found).abs() > 1e-9 * size
        });
        if far {
            let name = &arm.joints[i].name;
            return Err(format!("the new text does not give joint `{name}` the new numbers, so nothing is written"));
        }
    }
    Ok(())
}
