//! Attributes as numbers, with what must hold for them.

use armgen_codegen::diagnostic::{Diagnostic, Diagnostics};
use armgen_codegen::exact::Rational;
use armgen_codegen::source::{Source, Span};
use roxmltree::Node;

use crate::number::{decimal, ending, Decimal};
use crate::pose::Turn;
use crate::snap::Snap;
use crate::written::Written;
use crate::xml::{attribute, is_use, shown};
use crate::Code;

/// Reads numbers, reports faults, snaps.
pub(crate) struct Values<'r> {
    pub(crate) source: &'r Source,
    pub(crate) diagnostics: &'r mut Diagnostics,
    pub(crate) snap: Snap,
    pub(crate) inertia_as_written: bool,
    /// Links with an impossible tensor.
    pub(crate) impossible: Vec<String>,
    /// Bodies whose mass distributions are computed from geometries.
    pub(crate) computed: Vec<String>,
    /// How many position limits were left out since no arm has such.
    pub(crate) boundless: usize,
    /// Whether no link of the file has a mass distribution.
    pub(crate) kinematics_alone: bool,
    /// How many efforts of 0 were left out of such a file.
    pub(crate) unknown_efforts: usize,
}

/// A position limit, rad or m, beyond every arm: files write 1e16 or the largest float for a joint without limits.
const BOUNDLESS: f64 = 1e6;
/// A rate in rad/s, and one in m/s, beyond which no joint of an arm moves.
const FASTEST_TURN: f64 = 60.0;
const FASTEST_SLIDE: f64 = 20.0;

impl Values<'_> {
    pub(crate) fn report(&mut self, code: Code, span: Span, message: impl Into<String>, label: &str, help: impl Into<String>) {
        self.diagnostics.push(Diagnostic::new(code, span, message, label, help));
    }

    /// Exactly N numbers of an attribute, if it is there; `Some(None)` with a reported fault.
    pub(crate) fn vector<const N: usize>(
        &mut self,
        node: Node<'_, '_>,
        name: &str,
        what: &str,
    ) -> Option<Option<([Decimal; N], Span)>> {
        let (text, span) = attribute(node, name)?;
        Some(self.list(text, span, name, what).map(|numbers| (numbers, span)))
    }

    /// Exactly N numbers of a text; `None` with a reported fault.
    pub(crate) fn list<const N: usize>(&mut self, text: &str, span: Span, name: &str, what: &str) -> Option<[Decimal; N]> {
        let words: Vec<&str> = text.split_ascii_whitespace().collect();
        if words.len() != N && !is_use(text) {
            let (message, help) = match (N, words.len()) {
                (1, count) => {
                    let how = if count == 0 { "has no number".into() } else { format!("is `{}`, not one number", shown(text)) };
                    (format!("{what} {how}"), format!("write one number, such as `{name}=\"1\"`"))
                }
                (_, count) => (
                    format!("{what} has {count} of {N} numbers"),
                    format!("write {N}, with blanks between them: `{name}=\"{}\"`", ["0"; N].join(" ")),
                ),
            };
            self.report(Code::WrongLength, span, message, "", help);
            return None;
        }
        <[Decimal; N]>::try_from(self.words(text, span, what)).ok()
    }

    /// The numbers of a text; those that are none are reported.
    pub(crate) fn words(&mut self, text: &str, span: Span, what: &str) -> Vec<Decimal> {
        // Places of words are known where the text stands as it is, without entities.
        let verbatim = self.source.slice(span) == text;
        let mut numbers = Vec::new();
        for word in text.split_ascii_whitespace() {
            let at = match verbatim {
                true => {
                    let start = span.start + (word.as_ptr() as usize - text.as_ptr() as usize);
                    Span::new(start, start + word.len())
                }
                false => span,
            };
            numbers.extend(decimal(word, at, what, self.diagnostics));
        }
        numbers
    }

    /// One number; `None` if it is not there, or faulty and reported.
    pub(crate) fn scalar(&mut self, node: Node<'_, '_>, name: &str, what: &str) -> Option<Decimal> {
        let ([number], _) = self.vector::<1>(node, name, what)??;
        Some(number)
    }

    /// Three numbers, 0 where they are not there or faulty and reported.
    pub(crate) fn three(&mut self, node: Node<'_, '_>, name: &str, what: &str) -> [Decimal; 3] {
        let found = self.vector::<3>(node, name, what).flatten();
        found.map_or_else(|| std::array::from_fn(|_| Decimal::zero()), |(three, _)| three)
    }

    /// The direction of an axis and by how much it was turned; `None` if it is 0, which is reported.
    pub(crate) fn direction(&mut self, axis: &[Decimal; 3], span: Span, what: &str) -> Option<([Written; 3], f64)> {
        if axis.iter().all(Decimal::is_zero) {
            let help = "give the direction as a vector other than 0: `0 0 1`";
            self.report(Code::ZeroAxis, span, format!("{what} has no direction"), "all three are 0", help);
            return None;
        }
        Some(self.snap.direction(axis, span))
    }

    /// The rotation of a quaternion w, x, y, z; `None` if it is 0, which is reported.
    pub(crate) fn quaternion(&mut self, quat: &[Decimal; 4], span: Span, what: &str) -> Option<Turn> {
        if quat.iter().all(Decimal::is_zero) {
            let help = "a quaternion without rotation is 1 in w and 0 in x, y and z";
            self.report(Code::ZeroAxis, span, format!("{what} is 0, which is no rotation"), "all four are 0", help);
            return None;
        }
        Some(self.snap.quaternion(quat, span))
    }

    /// Position limits; `None` if absent, if one of them is beyond every arm, or if faulty and reported.
    pub(crate) fn position(
        &mut self,
        limit: Span,
        lower: Option<Decimal>,
        upper: Option<Decimal>,
        joint: &str,
    ) -> Option<[Decimal; 2]> {
        let given = lower.is_some() || upper.is_some();
        let (lower, upper) = (lower.unwrap_or_else(Decimal::zero), upper.unwrap_or_else(Decimal::zero));
        if lower.value < upper.value {
            let far = |limit: &Decimal| limit.value.abs() >= BOUNDLESS;
            if !far(&lower) && !far(&upper) {
                return Some([lower, upper]);
            }
            let what = if far(&lower) && far(&upper) { "which no joint reaches" } else { "one of which no joint reaches" };
            let message = format!(
                "the position limits of joint `{}` are {} to {}, {what}: they are taken as none",
                shown(joint),
                lower.text,
                upper.text
            );
            let help = "limits of 1e6 rad or m and more are what files have where there is none; write both if there are some";
            self.report(Code::PlaceholderLimit, limit, message, "left out", help);
            self.boundless += 1;
            return None;
        }
        if lower.is_zero() && upper.is_zero() {
            if given {
                let message = format!("the position limits of joint `{}` are 0 to 0, which is taken as unknown", shown(joint));
                self.report(Code::ZeroLimit, limit, message, "left out", "write the limits, or lock a joint that does not move");
            }
            return None;
        }
        let what = if lower.value > upper.value { "reversed" } else { "empty" };
        let message = format!("the position limits of joint `{}` are {what}: {} to {}", shown(joint), lower.text, upper.text);
        let help = format!("write the lower one below the upper one, or hold the joint: `--lock {}=VALUE`", shown(joint));
        self.report(Code::EmptyLimits, limit, message, "", help);
        None
    }

    /// A largest velocity or effort; one that is not above 0 is taken as unknown.
    pub(crate) fn largest(&mut self, value: Option<Decimal>, what: &str, joint: &str) -> Option<Decimal> {
        let value = value?;
        if value.value > 0.0 {
            return Some(value);
        }
        // Where nothing has mass, no torque is meant.
        if self.kinematics_alone && what == "effort" {
            self.unknown_efforts += 1;
            return None;
        }
        let message = format!("the {what} limit of joint `{}` is {}, which is taken as unknown", shown(joint), value.text);
        self.report(Code::ZeroLimit, value.span, message, "left out", "give the largest size that is allowed");
        None
    }

    /// A largest velocity; one that no joint reaches is taken as unknown, too: no bound is computed from it.
    ///
    /// A URDF cannot leave the velocity out, so files have 100, 1000 or 50000 where none is known. The limits are those beyond which a
    /// description is warned of.
    pub(crate) fn largest_velocity(&mut self, value: Option<Decimal>, slides: bool, joint: &str) -> Option<Decimal> {
        let value = self.largest(value, "velocity", joint)?;
        let (fastest, unit) = if slides { (FASTEST_SLIDE, "m/s") } else { (FASTEST_TURN, "rad/s") };
        if value.value <= fastest {
            return Some(value);
        }
        let message = format!(
            "the velocity limit of joint `{}` is {} {unit}, which no joint of an arm reaches: it is taken as unknown",
            shown(joint),
            value.text
        );
        // The suggestion is itself a limit.
        let instead = match slides {
            true => value.exact().as_rational().and_then(|v| ending(&(v.clone() / Rational::from(1000)))),
            false => Some(format!("deg({})", value.text)),
        };
        let size = if slides { value.value / 1e3 } else { value.value.to_radians() };
        let mut power = 100.0;
        while power < value.value {
            power *= 10.0;
        }
        let known = format!("give the largest rate in {unit}; files have such a number where none is known");
        let help = match instead.filter(|_| size <= fastest && power != value.value) {
            Some(instead) => format!(
                "if it is in {}, write `velocity: {instead}` among the `limits` of the joint in robot.yaml",
                if slides { "mm/s" } else { "degrees per second" }
            ),
            None => known,
        };
        self.report(Code::PlaceholderLimit, value.span, message, "left out", help);
        None
    }

    /// A coefficient of friction; `None` for 0.
    pub(crate) fn coefficient(&mut self, value: Option<Decimal>, joint: &str) -> Option<Decimal> {
        let help = "friction takes energy from the arm, so its coefficient is at least 0";
        self.not_negative(value, "a friction coefficient", joint, Code::NegativeFriction, help)
    }

    /// An inertia that only a joint feels; `None` for 0.
    pub(crate) fn armature(&mut self, value: Option<Decimal>, joint: &str) -> Option<Decimal> {
        self.not_negative(value, "the armature", joint, Code::NegativeArmature, "an inertia is at least 0")
    }

    /// The stiffness of a spring; `None` for 0.
    pub(crate) fn stiffness(&mut self, value: Option<Decimal>, joint: &str) -> Option<Decimal> {
        let help = "a spring pulls back to its rest, so its stiffness is at least 0";
        self.not_negative(value, "the stiffness", joint, Code::MjcfFeature, help)
    }

    /// A value above 0; `None` for 0, and a negative value is a fault.
    fn not_negative(&mut self, value: Option<Decimal>, what: &str, joint: &str, code: Code, help: &str) -> Option<Decimal> {
        let value = value.filter(|value| !value.is_zero())?;
        if value.value > 0.0 {
            return Some(value);
        }
        let message = format!("{what} of joint `{}` is negative: {}", shown(joint), value.text);
        self.report(code, value.span, message, "", help);
        None
    }

    /// One warning for all angles that are nearly a multiple of pi/12, at the first of them.
    pub(crate) fn warn_of_near_angles(&mut self) {
        // Who asks for every digit means them.
        let Some((span, text)) = self.snap.near.first().cloned().filter(|_| self.snap.tolerance > 0.0) else { return };
        let more = match self.snap.near.len() - 1 {
            0 => String::new(),
            more => format!(", and {more} more"),
        };
        let message = format!("the angle {text} is nearly, but not, a multiple of pi/12{more}");
        let help = "it is taken as written; `--snap TOL` takes what is within TOL rad of a multiple for that";
        self.report(Code::RoundedAngle, span, message, "taken as written", help);
    }
}
