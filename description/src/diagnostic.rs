//! Faults of a text: place, reason and remedy.
//!
//! A stage gathers [`Diagnostic`]s and goes on with what it could read; nobody sees the first fault alone.
//! There is one rendering, for terminal, build script and snapshots: [`Diagnostics::render`].

use std::collections::BTreeSet;

use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};

use crate::source::{Source, Span};

/// How bad it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    /// Nothing can be generated from the text.
    Error,
    /// The text is taken as written, but may not say what was meant.
    Warning,
}

impl Severity {
    /// Its word.
    pub fn name(self) -> &'static str {
        match self {
            Severity::Error => "error",
            Severity::Warning => "warning",
        }
    }
}

/// A code of any kind of file: its stable name and how bad it is. Enums of codes, made by [`codes!`](crate::codes), become it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct AnyCode {
    /// The place in its enum: of two diagnostics at one place, the earlier code comes first.
    order: u16,
    name: &'static str,
    severity: Severity,
    about: &'static str,
}

impl AnyCode {
    /// The code of a variant of [`codes!`](crate::codes).
    #[doc(hidden)]
    pub const fn new(order: u16, name: &'static str, severity: Severity, about: &'static str) -> AnyCode {
        AnyCode { order, name, severity, about }
    }

    /// The meaning: the documentation of the variant.
    pub fn about(self) -> &'static str {
        self.about.trim_start()
    }

    /// The stable name, as printed in brackets: `error[unknown-key]`.
    pub fn name(self) -> &'static str {
        self.name
    }

    /// Error or warning; a code is always the same one.
    pub fn severity(self) -> Severity {
        self.severity
    }
}

/// Declares an enum of codes: each variant with its documentation, `Error` or `Warning`, and its stable name; all of them are in `ALL`.
///
/// ```
/// armgen_description::codes! {
///     /// Kinds of faults of a calibration file.
///     pub enum Code {
///         /// The key `camera` names no camera.
///         UnknownCamera Error "unknown-camera",
///     }
/// }
/// assert_eq!(Code::ALL.len(), 1);
/// assert_eq!(Code::UnknownCamera.to_string(), "unknown-camera");
/// ```
#[macro_export]
macro_rules! codes {
    ($(#[$about:meta])* $visibility:vis enum $code:ident {
        $($(#[doc = $doc:literal])* $variant:ident $severity:ident $name:literal,)*
    }) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[non_exhaustive]
        $visibility enum $code {
            $($(#[doc = $doc])* $variant,)*
        }

        impl $code {
            /// Every code.
            $visibility const ALL: &'static [$code] = &[$($code::$variant,)*];

            /// The stable name, as printed in brackets: `error[unknown-key]`.
            $visibility fn name(self) -> &'static str {
                match self {
                    $($code::$variant => $name,)*
                }
            }

            /// Error or warning; a code is always the same one.
            $visibility fn severity(self) -> $crate::diagnostic::Severity {
                match self {
                    $($code::$variant => $crate::diagnostic::Severity::$severity,)*
                }
            }
        }

        impl From<$code> for $crate::diagnostic::AnyCode {
            fn from(code: $code) -> Self {
                let about = match code {
                    $($code::$variant => concat!($($doc),*),)*
                };
                $crate::diagnostic::AnyCode::new(code as u16, code.name(), code.severity(), about)
            }
        }

        impl PartialEq<$code> for $crate::diagnostic::AnyCode {
            fn eq(&self, code: &$code) -> bool {
                *self == Self::from(*code)
            }
        }

        impl std::fmt::Display for $code {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str(self.name())
            }
        }
    };
}

codes! {
    /// Kinds of diagnostics of a description.
    pub enum Code {
        // The text as YAML.
        /// The file holds nothing.
        EmptyFile Error "empty-file",
        /// The text is not YAML.
        YamlSyntax Error "yaml-syntax",
        /// A part of YAML that a description has no use for: tags, several documents, merge keys.
        YamlFeature Error "yaml-feature",
        /// The text, its nesting or its aliases exceed what a description may need.
        TooLarge Error "too-large",
        /// A key stands twice in one mapping.
        DuplicateKey Error "duplicate-key",

        // Keys and kinds.
        /// A key that means nothing here.
        UnknownKey Error "unknown-key",
        /// A required key is absent.
        MissingKey Error "missing-key",
        /// A mapping where a number is expected, and the like.
        WrongKind Error "wrong-kind",
        /// A list with too few or too many elements.
        WrongLength Error "wrong-length",
        /// Two rotations in one pose, or at one tensor.
        SeveralRotations Error "several-rotations",
        /// None of `standard`, `modified`, `urdf`.
        UnknownConvention Error "unknown-convention",
        /// Neither `revolute` nor `prismatic`.
        UnknownJointType Error "unknown-joint-type",

        // Numbers and expressions.
        /// Not an expression.
        BadExpression Error "bad-expression",
        /// A name that `parameters` does not define above its use.
        UnknownName Error "unknown-name",
        /// NaN or an infinity.
        NotFinite Error "not-finite",
        /// A number beyond the range of the scalar, or so small that it becomes 0 there.
        OutOfRange Error "out-of-range",
        /// A divisor that is 0.
        DivisionByZero Error "division-by-zero",
        /// The root of a negative number.
        NegativeRoot Error "negative-root",
        /// An expression whose exact value would grow too large to work with.
        TooComplex Error "too-complex",

        // Units.
        /// `units` names what is no unit of the key.
        UnknownUnit Error "unknown-unit",
        /// A plain number in the unit of the file beside an angle in radians.
        MixedUnits Error "mixed-units",
        /// `products` is neither `tensor` nor `integral`.
        UnknownProducts Error "unknown-products",

        // Names.
        /// A name that is not an identifier.
        BadName Error "bad-name",
        /// A name that has a meaning already.
        ReservedName Error "reserved-name",
        /// A name given to two things of one kind.
        DuplicateName Error "duplicate-name",

        // The arm.
        /// An arm without joints.
        NoJoints Error "no-joints",
        /// More joints than can be generated.
        TooManyJoints Error "too-many-joints",
        /// `parent` names no joint.
        UnknownParent Error "unknown-parent",
        /// `parent` names the joint itself or one further down.
        LateParent Error "late-parent",
        /// `mount` beside no `parent`.
        MountWithoutParent Error "mount-without-parent",
        /// `tip`, `joint` of an end effector, or `joint` or `with` of `closes` names no joint.
        UnknownTipJoint Error "unknown-tip-joint",
        /// Two end effectors of one name.
        DuplicateTip Error "duplicate-tip",
        /// More end effectors than a robot may have.
        TooManyTips Error "too-many-tips",
        /// An end effector's name makes names of the module that are taken.
        NameTaken Error "name-taken",
        /// A key of a single end effector beside `tips`.
        TipsBesideTool Error "tips-beside-tool",
        /// `follows`, `adds` or the `coupling` of a motor names no joint, or the motor's own.
        UnknownLeader Error "unknown-leader",
        /// Joints that follow each other.
        RingOfFollowers Error "ring-of-followers",
        /// A factor of 0 in `follows`, `adds` or the `coupling` of a motor.
        ZeroFactor Error "zero-factor",
        /// `on` of a motor names no joint.
        UnknownCarrier Error "unknown-carrier",
        /// `on` of a motor without `axis`.
        CarrierWithoutAxis Error "carrier-without-axis",
        /// `follows` and `adds` at one joint.
        FollowsAndAdds Error "follows-and-adds",
        /// `offset` beside neither `follows` nor `adds`.
        OffsetWithoutLeader Error "offset-without-leader",
        /// Friction that grows with the load of a coupled joint.
        CoupledLoad Error "coupled-load",
        /// Dry friction at the rate of a joint that is no coordinate's.
        CoupledFriction Error "coupled-friction",
        /// Smooth friction without Coulomb friction, or beside friction that jumps as the joint turns back.
        SmoothFriction Error "smooth-friction",
        /// A mass below 0.
        NegativeMass Error "negative-mass",
        /// An inertia tensor that is not positive semidefinite.
        ImpossibleInertia Error "impossible-inertia",
        /// A rotor inertia below 0.
        NegativeRotorInertia Error "negative-rotor-inertia",
        /// A friction coefficient below 0.
        NegativeFriction Error "negative-friction",
        /// A gear ratio of 0.
        ZeroRatio Error "zero-ratio",
        /// An armature below 0.
        NegativeArmature Error "negative-armature",
        /// A stiffness below 0.
        NegativeStiffness Error "negative-stiffness",
        /// An axis or a rotation without a direction.
        ZeroAxis Error "zero-axis",
        /// A position range that holds no interval.
        EmptyLimits Error "empty-limits",
        /// A velocity or effort limit that is not positive.
        NonPositiveLimit Error "non-positive-limit",

        // Task and regressor.
        /// A task row that does not exist.
        UnknownTaskRow Error "unknown-task-row",
        /// A task row named twice.
        DuplicateTaskRow Error "duplicate-task-row",
        /// A target of inverse kinematics that does not exist.
        UnknownTarget Error "unknown-target",
        /// `given` names no joint.
        UnknownGivenJoint Error "unknown-given-joint",
        /// A list that must name something names nothing.
        EmptyList Error "empty-list",
        /// `regressor` lists a name that `parameters` does not define.
        UnknownParameter Error "unknown-parameter",
        /// `regressor` lists a name twice.
        RepeatedParameter Error "repeated-parameter",
        /// tau is not linear in a name that `regressor` lists.
        NonlinearParameter Error "nonlinear-parameter",
        /// Gravity is an argument, and its nominal value holds a name that `regressor` lists.
        GravityArgument Error "gravity-argument",
        /// No joint moves any row of the task.
        ImmovableTask Error "immovable-task",
        /// The inertia matrix is singular for every q.
        SingularInertia Error "singular-inertia",
        /// Two links do not share the point of `closes` in every posture.
        OpenLoop Error "open-loop",

        /// `allow` names what is no kind of warning.
        UnknownWarning Error "unknown-warning",

        // Warnings.
        /// An arm with branches whose file names no end effector.
        OneTip Warning "one-tip",
        /// An effort limit of a joint without a coordinate.
        FollowerEffort Warning "follower-effort",
        /// A factor of so many digits that its angle is taken as unrelated to that of its leader.
        UnrelatedFactor Warning "unrelated-factor",
        /// Principal moments that no body has.
        TriangleInequality Warning "triangle-inequality",
        /// A tensor that no body has, taken as written since the file allows it.
        InertiaAsWritten Warning "inertia-as-written",
        /// A parameter that nothing uses.
        UnusedParameter Warning "unused-parameter",
        /// A centre of mass, or the place of a rotor, where there is no mass.
        NoEffect Warning "no-effect",
        /// An angle so large that degrees were probably meant.
        DegreesSuspected Warning "degrees-suspected",
        /// A decimal that is nearly a multiple of pi/12.
        RoundedAngle Warning "rounded-angle",
        /// Nothing in the arm has mass or inertia.
        NoDynamics Warning "no-dynamics",
        /// A length that no arm has.
        ImplausibleReach Warning "implausible-reach",
        /// Masses that do not fit the size of the arm.
        ImplausibleMass Warning "implausible-mass",
        /// One link that outweighs all others by far.
        OutlyingMass Warning "outlying-mass",
        /// A centre of mass farther away than the arm is long.
        ImplausibleCom Warning "implausible-com",
        /// A radius of gyration beyond what the link spans.
        ImplausibleInertia Warning "implausible-inertia",
        /// A radius of gyration beyond what the link spans, of a tensor as templates have it.
        PlaceholderInertia Warning "placeholder-inertia",
        /// An inertia smaller than that of any solid of the mass.
        ImplausibleDensity Warning "implausible-density",
        /// A heavy link without an inertia.
        MissingInertia Warning "missing-inertia",
        /// A rotor inertia that seems to be the one at the joint.
        ReflectedRotor Warning "reflected-rotor",
        /// A gear that would speed up.
        InvertedRatio Warning "inverted-ratio",
        /// Two joints that turn about one line.
        CoincidentAxes Warning "coincident-axes",
        /// A tensor that seems to be about the origin of the frame.
        InertiaAboutFrame Warning "inertia-about-frame",
        /// A gravity of no planet.
        ImplausibleGravity Warning "implausible-gravity",
        /// A velocity limit beyond what joints reach.
        ImplausibleVelocity Warning "implausible-velocity",
        /// An effort limit beyond any motor of the arm.
        ImplausibleEffort Warning "implausible-effort",
        /// Friction that would hold the arm still, or that fades where nothing creeps.
        ImplausibleFriction Warning "implausible-friction",
        /// An armature larger than the whole arm at its reach.
        ImplausibleArmature Warning "implausible-armature",
        /// An effort limit that friction or gravity alone takes.
        WeakEffort Warning "weak-effort",
        /// Friction that feeds energy in within the limits.
        ActiveFriction Warning "active-friction",
        /// A length or an angle that is next to nothing.
        Dust Warning "dust",
    }
}

/// A place in the text, with a description.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Label {
    /// The place.
    pub span: Span,
    /// A description of the place; may be empty.
    pub text: String,
}

/// One fault or one doubt.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// Its kind.
    pub code: AnyCode,
    /// The fault, in one sentence.
    pub message: String,
    /// Its places; the first label is the place of the diagnostic.
    pub labels: Vec<Label>,
    /// The remedy.
    pub help: String,
}

impl Diagnostic {
    /// A diagnostic at `span`, which says `label` there.
    pub fn new(
        code: impl Into<AnyCode>,
        span: Span,
        message: impl Into<String>,
        label: impl Into<String>,
        help: impl Into<String>,
    ) -> Diagnostic {
        Diagnostic {
            code: code.into(),
            message: message.into(),
            labels: vec![Label { span, text: label.into() }],
            help: help.into(),
        }
    }

    /// With a second place that has to do with it.
    #[must_use]
    pub fn also(mut self, span: Span, text: impl Into<String>) -> Diagnostic {
        self.labels.push(Label { span, text: text.into() });
        self
    }

    /// Its place.
    pub fn span(&self) -> Span {
        self.labels[0].span
    }
}

/// With or without colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Colour {
    /// Plain text.
    Never,
    /// ANSI colours, for a terminal.
    Always,
}

/// At most so many are rendered: more of them come from a text that is no description at all.
const RENDERED: usize = 500;

/// Once the lines shown come to so many bytes, the rest is only counted: in a file that is one long line each diagnostic costs the whole of it.
const RENDERED_BYTES: usize = 1 << 20;

/// Diagnostics of one text.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Diagnostics {
    list: Vec<Diagnostic>,
    seen: BTreeSet<(Span, AnyCode)>,
}

impl Diagnostics {
    /// An empty list.
    pub fn new() -> Diagnostics {
        Diagnostics::default()
    }

    /// Adds one; a second one of the same kind at the same place says nothing new and is dropped.
    pub fn push(&mut self, diagnostic: Diagnostic) {
        if self.seen.insert((diagnostic.span(), diagnostic.code)) {
            self.list.push(diagnostic);
        }
    }

    /// Adds the diagnostics of another stage.
    pub fn extend(&mut self, others: Diagnostics) {
        for diagnostic in others.list {
            self.push(diagnostic);
        }
    }

    /// Drops the warnings of these kinds.
    pub fn allow<S: AsRef<str>>(&mut self, kinds: &[S]) {
        self.list.retain(|d| d.code.severity() == Severity::Error || !kinds.iter().any(|kind| kind.as_ref() == d.code.name()));
    }

    /// In the order of the text.
    pub fn sort(&mut self) {
        self.list.sort_by_key(|d| (d.span().start, d.code.severity(), d.code));
    }

    /// The diagnostics.
    pub fn iter(&self) -> impl Iterator<Item = &Diagnostic> {
        self.list.iter()
    }

    /// Whether there are no diagnostics.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Number of errors.
    pub fn errors(&self) -> usize {
        self.list.iter().filter(|d| d.code.severity() == Severity::Error).count()
    }

    /// Number of warnings.
    pub fn warnings(&self) -> usize {
        self.list.len() - self.errors()
    }

    /// Whether one of them is an error.
    pub fn has_errors(&self) -> bool {
        self.errors() > 0
    }

    /// As text, each with `NAME:LINE:COLUMN` and the source line underlined, in the order of [`Diagnostics::iter`].
    pub fn render(&self, source: &Source, colour: Colour) -> String {
        let (mut text, mut rendered, mut bytes) = (String::new(), 0, 0);
        let mut names_error = !self.has_errors();
        for diagnostic in &self.list {
            let is_error = diagnostic.code.severity() == Severity::Error;
            // One error is always shown, after any number of warnings: it is the reason why there is no arm.
            if (rendered >= RENDERED || bytes >= RENDERED_BYTES) && (names_error || !is_error) {
                continue;
            }
            names_error |= is_error;
            let window = window(diagnostic, source);
            text.push_str(&render(diagnostic, source, window, colour));
            text.push_str("\n\n");
            rendered += 1;
            bytes += window.end - window.start;
        }
        if self.list.len() > rendered {
            text.push_str(&format!("{}: {} more not shown\n\n", source.name(), self.list.len() - rendered));
        }
        text
    }
}

/// The lines from the first label to the last: the renderer reads all the text that it is given.
fn window(diagnostic: &Diagnostic, source: &Source) -> Span {
    source.lines(diagnostic.labels.iter().map(|label| label.span).reduce(Span::to).expect("a diagnostic has a label"))
}

fn render(diagnostic: &Diagnostic, source: &Source, window: Span, colour: Colour) -> String {
    let Diagnostic { code, message, labels, help } = diagnostic;
    let level = match code.severity() {
        Severity::Error => Level::ERROR,
        Severity::Warning => Level::WARNING,
    };
    let within = |span: Span| span.start - window.start..span.end - window.start;
    // A carriage return would show as a symbol at the end of each line.
    let lines = source.slice(window).replace("\r\n", " \n");
    let lines = lines.strip_suffix('\r').unwrap_or(&lines).replace('\r', "\n");
    let mut snippet = Snippet::source(lines).path(source.name()).line_start(source.place(window.start).line);
    for (i, label) in labels.iter().enumerate() {
        let kind = if i == 0 { AnnotationKind::Primary } else { AnnotationKind::Context };
        let annotation = kind.span(within(source.first_line(label.span)));
        snippet = snippet.annotation(if label.text.is_empty() { annotation } else { annotation.label(label.text.as_str()) });
    }
    let report =
        [level.primary_title(message.as_str()).id(code.name()).element(snippet).element(Level::HELP.message(help.as_str()))];
    let renderer = match colour {
        Colour::Never => Renderer::plain(),
        Colour::Always => Renderer::styled(),
    };
    renderer.render(&report)
}

#[cfg(test)]
mod tests;
