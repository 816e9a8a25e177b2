//! The module of inverse kinematics: constants of the arm, one function, and the texts of the building blocks that it calls.

use armgen_inverse_kinematics::texts::{Text, TEXTS};
use proc_macro2::{Literal, TokenStream};
use quote::{format_ident, quote, ToTokens};

use super::literal::literal;
use super::runtime::is_implemented;
use super::signature::usize_literal;
use super::{format, head};
use crate::emit::Origin;
use crate::inverse_kinematics::{
    Arrangement, Construction, Frame, InverseKinematics, Redundancy, Regional, Solved, Sums, Target,
};
use crate::kinds::{JointKind, Scalar};
use crate::manipulator::Manipulator;
use crate::program::Module;

/// The module's text. For an arm without a construction it is a comment with the reason.
pub fn print_inverse_kinematics(of: &Solved, scalar: Scalar, origin: &Origin) -> String {
    let lines = |text: &str| text.lines().map(|line| format!("// {line}\n")).collect::<String>();
    let head = head(origin, &[]) + &of.head().map_or_else(String::new, |line| lines(&line));
    match &of.found {
        Err(reason) => head + &lines(&format!("There is no `inverse_kinematics`: {reason}.")),
        Ok(found) => {
            let class = format!("Inverse kinematics: {}; at most {} solutions.\n", found.class, found.most);
            head + &lines(&class) + "\n" + &format(exported(found)) + &solver(&of.arm, scalar, found)
        }
    }
}

/// The implementation of the runtime's trait, to follow the other traits. It refers to the module of inverse kinematics, next to
/// the robot's, by its name. Empty for an arm without a construction, and for a module without the kinematics that the trait
/// needs.
pub fn print_inverse_kinematics_trait(module: &Module, found: &Result<InverseKinematics, String>, ik: &str) -> String {
    let Some(found) = found.as_ref().ok().filter(|_| is_implemented(module, "Kinematics")) else { return String::new() };
    let signs = found.choices.iter().filter(|choice| choice.ways.len() == 2).fold(0u16, |signs, choice| signs | 1 << choice.bit);
    let signs = Literal::u16_unsuffixed(signs);
    let ik = format_ident!("{ik}");
    let robot = quote!(armgen_runtime::robot);
    let postures = quote!(#robot::Postures<Real, DOF, { super::#ik::MAX_SOLUTIONS }>);
    // One argument more, and one function, of a redundant arm.
    let (interface, parameter, argument, redundancy) = match found.redundancy {
        None => (quote!(InverseKinematics), None, None, None),
        Some(_) => {
            let function = quote! {
                fn redundancy(&self, q: &armgen_runtime::nalgebra::SVector<Real, DOF>) -> Real {
                    super::#ik::inverse_kinematics_redundancy(&armgen_runtime::robot::array(q))
                }
            };
            (quote!(RedundantInverseKinematics), Some(quote!(, redundancy: Real)), Some(quote!(, redundancy)), Some(function))
        }
    };
    let implementation = |of: TokenStream| {
        quote! {
            impl #robot::JointRanges<DOF> for #of {
                fn turns(&self) -> [bool; DOF] {
                    JOINT_IS_REVOLUTE
                }
                fn position_limits(&self) -> [[Real; 2]; DOF] {
                    POSITION_LIMITS
                }
            }

            impl #robot::#interface<DOF, { super::#ik::MAX_SOLUTIONS }> for #of {
                fn inverse_kinematics(&self, pose: &armgen_runtime::nalgebra::Matrix4<Real> #parameter) -> #postures {
                    postures(pose #argument)
                }
                #redundancy
                fn branch_signs(&self) -> u16 {
                    #signs
                }
            }
        }
    };
    let nominal = implementation(quote!(Nominal));
    let has_dynamics = is_implemented(module, "Dynamics");
    let mounted = (has_dynamics && module.gravity_is_argument).then(|| implementation(quote!(Mounted)));
    let with_parameters = has_dynamics.then(|| implementation(quote!(WithParameters)));
    let text = quote! {
        #nominal
        #mounted
        #with_parameters

        /// The postures that the module of inverse kinematics finds, in the runtime's types. No parameter enters them.
        fn postures(pose: &armgen_runtime::nalgebra::Matrix4<Real> #parameter) -> #postures {
            let t = core::array::from_fn(|i| core::array::from_fn(|j| pose[(i, j)]));
            let found = super::#ik::inverse_kinematics(&t #argument);
            #robot::Postures {
                verdict: match found.verdict {
                    super::#ik::Verdict::Complete => #robot::Verdict::Complete,
                    super::#ik::Verdict::Unreachable => #robot::Verdict::Unreachable,
                    super::#ik::Verdict::NearDouble => #robot::Verdict::NearDouble,
                    super::#ik::Verdict::Continuum => #robot::Verdict::Continuum,
                    super::#ik::Verdict::Invalid => #robot::Verdict::Invalid,
                },
                miss: found.miss,
                count: found.count,
                all: found.all.map(|solution| #robot::Posture {
                    q: armgen_runtime::nalgebra::SVector::from(solution.q),
                    branch: solution.branch,
                    double: solution.double,
                    free: solution.free,
                }),
            }
        }
    };
    "\n".to_owned() + &format(text)
}

/// The tests of inverse kinematics, to follow the module's tests in `robot_test.rs`. `file` contains the module of inverse
/// kinematics. Empty for an arm without a construction.
pub fn print_inverse_kinematics_test(of: &Solved, scalar: Scalar, file: &str) -> String {
    let Ok(found) = &of.found else { return String::new() };
    // Units of rounding times a condition that most random postures have.
    let (near, far) = match scalar {
        Scalar::F64 => ("1e-9", "1e-5"),
        Scalar::F32 => ("2e-3", "0.1"),
    };
    let columns = format!("{}..", found.target.first_column());
    let (uses, at_posture) = match found.redundancy {
        None => ("", ""),
        Some(_) => ("inverse_kinematics_redundancy, ", ", inverse_kinematics_redundancy(&q)"),
    };
    include_str!("inverse_kinematics_test.rs.txt")
        .replace("{file}", &format!("{file:?}"))
        .replace("{uses}", uses)
        .replace("{at_posture}", at_posture)
        .replace("{near}", near)
        .replace("{far}", far)
        .replace("{columns}", &columns)
}

/// The items before the module of the blocks.
fn exported(found: &InverseKinematics) -> TokenStream {
    let redundancy = found.redundancy.as_ref().map(|_| quote!(inverse_kinematics_redundancy,));
    quote! {
        #[allow(unused_imports)]
        pub use self::all_solutions::{inverse_kinematics, #redundancy Posture, Postures, Real, Solution, Solutions, Verdict, BRANCHES, DOF, MAX_SOLUTIONS};
    }
}

/// The module of the blocks.
fn solver(manipulator: &Manipulator, scalar: Scalar, found: &InverseKinematics) -> String {
    let mut text = String::from(
        "\n/// The construction and its building blocks.\n#[allow(dead_code, unreachable_pub, clippy::all, clippy::pedantic)]\n#[rustfmt::skip]\nmod all_solutions {\n\n",
    );
    text += &items(manipulator, scalar, found);
    text + "}\n"
}

/// The items in the module of the blocks: constants, one function, and the blocks that it calls.
pub(in crate::emit) fn items(manipulator: &Manipulator, scalar: Scalar, found: &InverseKinematics) -> String {
    let mut text = format(constants(manipulator, scalar, found));
    text.push('\n');
    text += &format(function(found, manipulator.dof()));
    for block in needed(scalar, found) {
        text.push('\n');
        text += block.source;
    }
    text
}

/// The texts that a construction needs, each after those that it needs itself.
fn needed(scalar: Scalar, found: &InverseKinematics) -> Vec<&'static Text> {
    let scalar = match scalar {
        Scalar::F64 => "scalar_f64",
        Scalar::F32 => "scalar_f32",
    };
    let mut names = vec![scalar, "arrangement", "solutions"];
    names.extend(found.given().map(|_| "given"));
    names.extend(found.own.as_ref().map(|_| "virtual_joints"));
    names.extend(found.coordinates.as_ref().map(|_| "coordinates"));
    match &found.construction {
        Construction::SphericalTriple(_, case) => {
            names.extend(["spherical_triple", case.text]);
            names.extend(found.own.is_none().then_some("closure"));
        }
        Construction::ThreeParallel(..) => {
            names.push("parallel_axes");
            names.extend(found.own.is_none().then_some("closure"));
        }
        Construction::ParallelTurns(_, case) => names.extend(["parallel_turns", case.text]),
        Construction::Position(_, case) => {
            names.push(case.text);
            names.extend((!case.closed).then_some("closure"));
        }
        Construction::ThreePrismatic(..) => {
            names.push("three_prismatic");
            names.extend(found.own.is_none().then_some("closure"));
        }
        Construction::TwoSlides(..) => names.push("two_slides"),
        Construction::ShoulderElbowWrist(_) => names.push("shoulder_elbow_wrist"),
        Construction::General(_) => names.push("general"),
    }
    let mut texts = Vec::new();
    for text in TEXTS.iter().rev() {
        if names.contains(&text.name) {
            names.extend(text.needs);
            texts.push(text);
        }
    }
    texts.reverse();
    texts
}

/// What the postures consist of, and one of them.
pub(in crate::emit) fn entries(found: &InverseKinematics) -> [&'static str; 2] {
    match found.coordinates {
        None => ["joint variables", "joint"],
        Some(_) => ["coordinates", "coordinate"],
    }
}

fn constants(manipulator: &Manipulator, scalar: Scalar, found: &InverseKinematics) -> TokenStream {
    let coordinates = manipulator.coordinates();
    let (dof, most) = (usize_literal(coordinates.len()), usize_literal(found.most));
    let prismatic = coordinates.iter().map(|coordinate| coordinate.joint.kind == JointKind::Prismatic);
    let limits = coordinates.iter().map(|coordinate| match &coordinate.limits.position {
        None => quote!([Real::NEG_INFINITY, Real::INFINITY]),
        Some(limits) => {
            let [low, high] = limits.each_ref().map(|limit| literal(limit, scalar));
            quote!([#low, #high])
        }
    });
    let branches = found.branches();
    let count = usize_literal(branches.len());
    let meanings = meanings(found, "`LOOP`");
    let loops = match found.loops() {
        [way] => {
            let (count, way) = (usize_literal(way.order.len()), arrangement(way, scalar));
            quote! {
                /// The arm's loop in the order in which the construction reads it.
                const LOOP: Arrangement<#count> = #way;
            }
        }
        ways => {
            let ways = ways.iter().map(|way| arrangement(way, scalar));
            quote! {
                /// The arm's loop in the orders in which the determinant is taken.
                const LOOPS: [Arrangement<6>; 2] = [#(#ways),*];
            }
        }
    };
    let own = found.own.as_ref().map(|way| {
        let way = arrangement(way, scalar);
        quote! {
            /// The loop of the arm's own joints, from joint 1 on; those behind them stay at 0.
            const ARM: Arrangement<6> = #way;
        }
    });
    let length = literal(&found.length, scalar);
    let given = found.given().map(|given| {
        let (joint, prismatic) = (usize_literal(given.joint), given.prismatic);
        let (before, after) = (frame(&given.before, scalar), frame(&given.after, scalar));
        quote! {
            /// The joint whose value is given.
            const GIVEN: Given = Given { joint: #joint, prismatic: #prismatic, before: #before, after: #after };
        }
    });
    let [_, entry] = entries(found);
    let lowest = match found.coordinates {
        None => "joint variable",
        Some(_) => "coordinate",
    };
    let about = [
        format!(" Number of {entry}s."),
        format!(" Whether a {entry} slides."),
        format!(" Lowest and highest {lowest}, rad or m; infinite where the description gives none."),
    ];
    let [number, slides, lowest] = &about;
    let coupled = coupled(scalar, found);
    quote! {
        #[doc = #number]
        pub const DOF: usize = #dof;
        /// At most so many postures reach a pose, where they are finitely many.
        pub const MAX_SOLUTIONS: usize = #most;
        #(#[doc = #meanings])*
        pub const BRANCHES: [&str; #count] = [#(#branches),*];
        #[doc = #slides]
        const PRISMATIC: [bool; DOF] = [#(#prismatic),*];
        #[doc = #lowest]
        const POSITION_LIMITS: [[Real; 2]; DOF] = [#(#limits),*];
        /// The arm's largest length, m.
        const LENGTH: Real = #length;
        #loops
        #own
        #given
        #coupled
    }
}

/// The constants between joint variables and coordinates.
fn coupled(scalar: Scalar, found: &InverseKinematics) -> Option<TokenStream> {
    let coordinates = found.coordinates.as_ref()?;
    let parts = |sums: &Sums| {
        let rows = sums.factors.iter().map(|row| {
            let factors = row.iter().map(|factor| literal(factor, scalar));
            quote!([#(#factors),*])
        });
        let offset = sums.offset.iter().map(|constant| literal(constant, scalar));
        (quote!([#(#rows),*]), quote!([#(#offset),*]))
    };
    let back = found.redundancy.as_ref().map(|_| {
        let (factors, offset) = parts(&coordinates.variables);
        quote! {
            /// Joint variables q over coordinates p: q = `COUPLING` p + `COUPLING_OFFSET`.
            const COUPLING: [[Real; DOF]; DOF] = #factors;
            /// See `COUPLING`, rad or m.
            const COUPLING_OFFSET: [Real; DOF] = #offset;
        }
    });
    let (factors, offset) = parts(&coordinates.coordinates);
    let slides = &coordinates.slides;
    Some(quote! {
        /// Whether a joint slides, of those from the base to the end effector.
        const JOINT_SLIDES: [bool; DOF] = [#(#slides),*];
        /// Coordinates p over joint variables q: p = `COORDINATES` q + `COORDINATE_OFFSET`.
        const COORDINATES: [[Real; DOF]; DOF] = #factors;
        /// See `COORDINATES`, rad or m.
        const COORDINATE_OFFSET: [Real; DOF] = #offset;
        #back
    })
}

/// The documentation of `BRANCHES`: the meaning of each bit. `way` names the item with the constants of the loop, in words.
pub(in crate::emit) fn meanings(found: &InverseKinematics, way: &str) -> Vec<String> {
    if found.choices.is_empty() {
        return vec![
            " The names of branches: none, for the solutions are ordered by their joint variables, and `branch` is 0.".into()
        ];
    }
    let mut lines = vec![
        " What a solution's `branch` says, by its number; empty where no solution has it. A bit is 0 in the first of its ways, where the sign".into(),
        format!(" that is named is positive (angles as the loop has them: with the `offsets` of {way}). The words are names of the signs, not of the looks of"),
        " the arm:".into(),
        String::new(),
    ];
    for choice in &found.choices {
        let bits = match choice.ways.len() {
            2 => format!("bit {}", choice.bit),
            _ => format!("bits {} and {}", choice.bit, choice.bit + 1),
        };
        lines.push(format!(" - {bits}, {}: {}.", choice.ways.join(", "), choice.meaning));
    }
    lines
}

fn frame(f: &Frame, scalar: Scalar) -> TokenStream {
    let rows = f.iter().map(|row| {
        let entries = row.iter().map(|entry| literal(entry, scalar));
        quote!([#(#entries),*])
    });
    quote!([#(#rows),*])
}

fn arrangement(way: &Arrangement, scalar: Scalar) -> TokenStream {
    let order = way.order.iter().map(|joint| usize_literal(*joint));
    let prismatic = &way.prismatic;
    let links = way.links.iter().map(|link| frame(link, scalar));
    let (open, backward) = (usize_literal(way.open), way.backward);
    let (before, after) = (frame(&way.before, scalar), frame(&way.after, scalar));
    let offsets = way.offsets.iter().map(|[c, s]| {
        let (c, s) = (literal(c, scalar), literal(s, scalar));
        quote!([#c, #s])
    });
    quote! {
        Arrangement {
            order: [#(#order),*],
            prismatic: [#(#prismatic),*],
            links: [#(#links),*],
            open: #open,
            before: #before,
            after: #after,
            backward: #backward,
            offsets: [#(#offsets),*],
        }
    }
}

/// The meaning of the argument `t`.
pub(in crate::emit) fn about_target(target: Target) -> &'static str {
    match target {
        Target::Pose => {
            "the pose of the end effector in the base frame, T = (R p; 0 1) by rows, lengths in m; the last row only has to be finite"
        }
        Target::Position => {
            "a pose of the end effector in the base frame by rows, lengths in m; the position alone is asked for, as far as the task has it"
        }
        Target::Pointing => {
            "a pose of the end effector in the base frame, T = (R p; 0 1) by rows, lengths in m, of which position and z axis are to be \
             reached; the last row only has to be finite"
        }
        Target::Planar => {
            "the pose of the end effector in the base frame, T = (R p; 0 1) by rows, lengths in m; the last row and what the task \
             leaves out only have to be finite"
        }
    }
}

/// The targets that are refused as `Invalid`.
pub(in crate::emit) fn what_is_invalid(found: &InverseKinematics) -> &'static str {
    match (found.target, &found.redundancy) {
        (Target::Position, None) => "an entry of t is not finite",
        (Target::Position, Some(_)) => "an entry of t or the redundancy is not finite",
        (_, None) => "an entry of t is not finite or its rotation none to 1e-6",
        (_, Some(_)) => "an entry of t is not finite or its rotation none to 1e-6, or the redundancy is not finite",
    }
}

/// The meaning of the argument after the pose, for a redundant arm.
pub(in crate::emit) fn about_redundancy(found: &InverseKinematics) -> Option<String> {
    Some(match found.redundancy.as_ref()? {
        Redundancy::Joint(given) => {
            let unit = if given.prismatic { "m" } else { "rad" };
            format!("the joint variable q{}, {unit}", given.joint + 1)
        }
        Redundancy::Swivel => {
            "the swivel angle, rad, of the elbow about the direction e from shoulder to wrist, from x towards e × x: x is k × e normalised, \
             k = (e + z0) × y0, y0 and z0 axes of the base frame; the elbow is the point of axis 4 that is nearest to axis 3"
                .into()
        }
    })
}

fn function(found: &InverseKinematics, dof: usize) -> TokenStream {
    let body = solutions(found, dof);
    let target = format!(" `t`: {}.", about_target(found.target));
    let given = arguments_read(found);
    let invalid = format!(" `Invalid`: {}.", what_is_invalid(found));
    let rows = found.own.as_ref().map(|_| {
        let tolerance = if matches!(found.construction, Construction::General(_)) { "`GENERAL_ROWS`" } else { "`ROUNDING`" };
        let lines = [
            " The arm has fewer joints than a pose has rows: a pose is reached where all rows are met,".to_owned(),
            format!(" to {tolerance} times the sum of the lengths in the arm's loop."),
            String::new(),
        ];
        quote!(#(#[doc = #lines])*)
    });
    let class = format!(" Class: {}; at most {} solutions.", found.class, found.most);
    let argument = found.redundancy.as_ref().map(|_| quote!(redundancy: Real));
    let about = about_redundancy(found).map(|about| {
        let about = format!(" `redundancy`: {about}.");
        quote!(#[doc = #about])
    });
    let redundancy = redundancy_of_a_posture(found);
    let [entries, entry] = entries(found);
    let all = format!(" All {entries} q with direct_kinematics(q) = t.");
    let free = format!(" effector stays, and those whose values the construction chose have a bit in `free` (bit i: {entry} i + 1). What `armgen verify` says");
    quote! {
        #[doc = #all]
        ///
        #[doc = #target]
        #about
        ///
        /// The verdict says what is known: `Complete`, all solutions are listed; `Unreachable`, there is none, and `miss` says by how much
        /// the construction missed; `NearDouble`, the rounding of t decides about some; `Continuum`, some joints can move while the end
        #[doc = #free]
        /// of this text holds in exact arithmetic at general poses; in floats, next to poses where solutions meet, the first two can be
        /// wrong.
        #[doc = #invalid]
        ///
        /// Angles are in (-pi, pi]; limits are not looked at (`within_limits` does). T(q) differs from t by roundings, of the order of 100
        /// units times the arm's length; q itself by that over the smallest singular value of the Jacobian, near a double solution by
        /// its root.
        ///
        #rows
        #[doc = #class]
        pub fn inverse_kinematics(t: &[[Real; 4]; 4], #argument) -> Solutions {
            let [x, y, z, _] = *t;
            #given
            #body
        }

        #redundancy
    }
}

/// The construction called, and its solutions in the order of the arm's joints.
fn solutions(found: &InverseKinematics, dof: usize) -> TokenStream {
    let kinds = |way: &Arrangement, count: usize| {
        let kinds = way.prismatic.iter().take(count);
        quote!([#(#kinds),*])
    };
    // Solutions of the arm's own joints are refined on their own. Of six joints those of closed forms are looked at where some meet.
    let polish = |polished: bool| {
        let closing = quote!(&Loop { links: &links, prismatic: LOOP.prismatic, target: [0.0; 3], length: LENGTH });
        let call = match polished {
            true => quote!(polish(&mut found, #closing);),
            false => quote!(close_where_solutions_meet(&mut found, #closing);),
        };
        found.own.is_none().then_some(call)
    };
    let links = match found.given().and_then(|given| given.place) {
        None => quote!(let links = LOOP.links_at(&t);),
        Some(place) => {
            let place = usize_literal(place);
            quote! {
                let mut links = LOOP.links_at(&t);
                links[#place] = GIVEN.link(value);
            }
        }
    };
    let conclusion = conclusion(found, dof);
    let in_order = quote! {
        let count = found.count;
        for branch in found.all.iter_mut().take(count) {
            *branch = LOOP.of_arm(branch);
        }
        #conclusion
    };
    match &found.construction {
        Construction::SphericalTriple(way, case) => {
            let (kinds, block) = (kinds(way, 3), format_ident!("{}", case.function));
            let polish = polish(!case.closed);
            quote! {
                #links
                let mut found = spherical_triple(&links, #kinds, #block);
                #polish
                #in_order
            }
        }
        Construction::ThreeParallel(_, polished) => {
            let polish = polish(*polished);
            quote! {
                #links
                let mut found = three_parallel(&links);
                #polish
                #in_order
            }
        }
        Construction::ParallelTurns(way, case) => {
            let (kinds, block) = (kinds(way, 3), format_ident!("{}", case.function));
            let found = match found.given().and_then(|given| given.place) {
                None => quote!(let mut found = parallel_turns(&LOOP.links_at(&t), #kinds, #block);),
                Some(_) => quote!(#links let mut found = parallel_turns(&links, #kinds, #block);),
            };
            quote! {
                #found
                #in_order
            }
        }
        Construction::Position(way, case) => {
            let found = position(found, way, case);
            quote! {
                #found
                #in_order
            }
        }
        Construction::ThreePrismatic(_, turning) => {
            let (turning, polish) = (turning.map(Literal::usize_unsuffixed), polish(false));
            quote! {
                #links
                let mut found = three_prismatic(&links, [#(#turning),*]);
                #polish
                #in_order
            }
        }
        Construction::TwoSlides(_, slides) => {
            let slides = slides.map(Literal::usize_unsuffixed);
            quote! {
                let mut found = two_slides(&LOOP.links_at(&t), [#(#slides),*], LENGTH);
                #in_order
            }
        }
        Construction::ShoulderElbowWrist(_) => quote! {
            let mut found = shoulder_elbow_wrist(&LOOP, &t, redundancy);
            #in_order
        },
        Construction::General(_) if found.given().is_some() => {
            let all = joints_with_given(6, dof);
            concluded(found, &quote!(&GIVEN.with::<6, #all, 16>(&general_arm(&LOOPS, &t, LENGTH), value)), true)
        }
        Construction::General(_) if found.own.is_some() => {
            let own =
                quote!(&without_virtual_joints::<6, DOF, 16>(&ARM, &general_arm(&LOOPS, &t, LENGTH), &t, LENGTH, GENERAL_ROWS));
            concluded(found, &own, true)
        }
        Construction::General(_) => concluded(found, &quote!(&general_arm(&LOOPS, &t, LENGTH)), true),
    }
}

/// The position of the end effector brought to its place.
fn position(found: &InverseKinematics, way: &Arrangement, case: &Regional) -> TokenStream {
    let block = format_ident!("{}", case.function);
    // The origin of the end effector from before the last joint of the loop, and where it is to go from before the first. Behind a last
    // joint that is given it is elsewhere.
    let moved = found.given().is_some_and(|given| given.place.is_none() && given.joint > 0);
    let tip = |frame: TokenStream| if moved { quote!(transform(&#frame, tip)) } else { quote!(column(&#frame, 3)) };
    let (from, to) = if way.backward {
        (quote!(transform(&LOOP.before, position)), tip(quote!(inverse(&LOOP.after))))
    } else {
        (tip(quote!(LOOP.before)), quote!(transform(&inverse(&LOOP.after), position)))
    };
    let links = match found.given().and_then(|given| given.place) {
        None => quote!(let [a, b, _] = LOOP.links;),
        Some(place) => {
            let place = usize_literal(place);
            quote! {
                let mut links = LOOP.links;
                links[#place] = GIVEN.link(value);
                let [a, b, _] = links;
            }
        }
    };
    let found = if case.closed {
        quote!(let mut found = #block(&a, &b, #from, #to);)
    } else {
        quote! {
            let (from, to) = (#from, #to);
            let mut found = #block(&a, &b, from, to);
            let links = [a, b, displaced(from)];
            polish(&mut found, &Loop { links: &links, prismatic: LOOP.prismatic, target: to, length: LENGTH });
        }
    };
    quote! {
        #links
        #found
    }
}

/// The expression that turns solutions of the loop's joints into solutions of the arm, in their order.
fn conclusion(found: &InverseKinematics, dof: usize) -> TokenStream {
    // Solutions without branches come in the order of their joint variables.
    let by_angle = matches!(found.construction, Construction::TwoSlides(..));
    let solutions = match (found.given(), &found.own) {
        (None, None) => quote!(&found),
        (None, Some(_)) => {
            let (joints, most) = match &found.construction {
                Construction::ParallelTurns(..) => (4, 4),
                _ => (6, 8),
            };
            let (joints, most) = (usize_literal(joints), usize_literal(most));
            quote!(&without_virtual_joints::<#joints, DOF, #most>(&ARM, &found, &t, LENGTH, ROUNDING))
        }
        (Some(_), _) => {
            let others = found.loops().first().map_or(0, |way| way.order.len());
            let all = joints_with_given(others, dof);
            let (others, most) = (usize_literal(others), usize_literal(if others == 6 { 8 } else { 4 }));
            quote!(&GIVEN.with::<#others, #all, #most>(&found, value))
        }
    };
    concluded(found, &solutions, by_angle)
}

/// The expression for the postures of solutions of the arm's joints, in its coordinates.
fn concluded(found: &InverseKinematics, solutions: &TokenStream, by_angle: bool) -> TokenStream {
    let rotation = (found.target != Target::Position).then(|| quote!(.of_rotation(&[x, y, z])));
    match found.coordinates {
        None => quote!(conclude(#solutions, PRISMATIC, #by_angle)#rotation),
        Some(_) => quote! {
            let joints: Solutions = conclude(#solutions, JOINT_SLIDES, #by_angle)#rotation;
            in_coordinates(&joints, COORDINATES, COORDINATE_OFFSET, PRISMATIC)
        },
    }
}

/// The number of joints including the given joint. With a virtual joint it exceeds the arm's.
fn joints_with_given(others: usize, dof: usize) -> TokenStream {
    match others + 1 {
        all if all == dof => quote!(DOF),
        all => usize_literal(all).into_token_stream(),
    }
}

/// The statements that read the arguments.
fn arguments_read(found: &InverseKinematics) -> TokenStream {
    match found.target {
        Target::Position => {
            let condition = found.redundancy.as_ref().map(|_| quote!(|| !redundancy.is_finite()));
            let value = found.given().map(|given| {
                let moved = match given.place {
                    Some(_) => None,
                    None if given.joint == 0 => Some(quote!(let position = transform(&inverse(&GIVEN.link(value)), position);)),
                    None => Some(quote!(let tip = column(&GIVEN.link(value), 3);)),
                };
                quote! {
                    let value = GIVEN.value(redundancy);
                    #moved
                }
            });
            quote! {
                let position = [x[3], y[3], z[3]];
                if !all_finite(t) #condition {
                    return Solutions::none(Verdict::Invalid);
                }
                #value
            }
        }
        _ if found.redundancy.is_some() => {
            let value = found.given().map(|given| match given.place {
                None => quote! {
                    let value = GIVEN.value(redundancy);
                    let t: Frame = GIVEN.rest(value, &[x, y, z]);
                },
                Some(_) => quote! {
                    let value = GIVEN.value(redundancy);
                    let t: Frame = [x, y, z];
                },
            });
            let value = value.unwrap_or(quote!(let t: Frame = [x, y, z];));
            quote! {
                if !is_pose(t) || !redundancy.is_finite() {
                    return Solutions::none(Verdict::Invalid);
                }
                #value
            }
        }
        Target::Pose | Target::Planar | Target::Pointing => {
            quote! {
                if !is_pose(t) {
                    return Solutions::none(Verdict::Invalid);
                }
                let t: Frame = [x, y, z];
            }
        }
    }
}

/// The function that returns the redundancy of a posture, for a redundant arm.
fn redundancy_of_a_posture(found: &InverseKinematics) -> Option<TokenStream> {
    found.redundancy.as_ref().map(|redundancy| {
        let variables = found.coordinates.as_ref().map(|_| quote!(let variables = sums_of(q, COUPLING, COUPLING_OFFSET);));
        let value = match (redundancy, &variables) {
            (Redundancy::Joint(given), None) => {
                let joint = usize_literal(given.joint);
                quote!(q[#joint])
            }
            (Redundancy::Joint(given), Some(variables)) => {
                let joint = usize_literal(given.joint);
                quote!(#variables variables[#joint])
            }
            (Redundancy::Swivel, None) => quote!(swivel_angle(&LOOP, q)),
            (Redundancy::Swivel, Some(variables)) => quote!(#variables swivel_angle(&LOOP, &variables)),
        };
        quote! {
            /// The `redundancy` of a posture, with which `inverse_kinematics` finds it again.
            pub fn inverse_kinematics_redundancy(q: &[Real; DOF]) -> Real {
                #value
            }
        }
    })
}
