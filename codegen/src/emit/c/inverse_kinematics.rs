//! The C interface of inverse kinematics: a header, and wrappers for the module `robot_ik.rs`.
//!
//! Solutions cross as structs of one layout on both sides (`repr(C)`): numbers of the scalar, and 32 bits for everything else.

use super::header::{comment, macros_of};
use super::CFace;
use crate::emit::documentation::Block;
use crate::emit::rust;
use crate::emit::Origin;
use crate::inverse_kinematics::{InverseKinematics, Solved, Target};
use crate::kinds::Scalar;

/// The verdicts in the order of their numbers, each with its comment in C; `None` for a comment that depends on the arm.
const VERDICTS: [(&str, Option<&str>); 5] = [
    ("Complete", Some("all solutions are listed, as far as the construction can tell")),
    ("Unreachable", Some("none was found; `miss` says by how much the construction missed")),
    ("NearDouble", Some("the rounding of t decides about some")),
    ("Continuum", Some("some joints can move while the end effector stays")),
    ("Invalid", None),
];

/// The C face of inverse kinematics; nothing where the arm has no construction.
pub fn print_inverse_kinematics(of: &Solved, scalar: Scalar, origin: &Origin) -> Option<CFace> {
    let found = of.found.as_ref().ok()?;
    let names = Names::of(of, scalar);
    Some(CFace { header: header(&names, of, found, origin), wrappers: wrappers(&names.robot, found, origin) })
}

/// The names of an arm's headers and of their contents.
pub(super) struct Names {
    pub(super) robot: String,
    pub(super) upper: String,
    pub(super) real: &'static str,
    pub(super) joints: usize,
}

impl Names {
    pub(super) fn of(of: &Solved, scalar: Scalar) -> Names {
        let (robot, joints) = (super::spelled(&of.arm.name), of.arm.dof());
        let real = match scalar {
            Scalar::F64 => "double",
            Scalar::F32 => "float",
        };
        Names { upper: macros_of(&robot), robot, real, joints }
    }
}

pub(super) fn said(lines: &[String]) -> String {
    comment(&[Block::Verbatim(lines.to_vec())], &|_| String::new())
}

fn header(names: &Names, of: &Solved, found: &InverseKinematics, origin: &Origin) -> String {
    let mut text = opening(names, of, found, origin);
    text += "#include <stdint.h>\n\n#ifdef __cplusplus\nextern \"C\" {\n#endif\n\n";
    text += &types(names, found, "`LOOP` in the module in Rust");
    let functions = functions(names, found);
    text += &functions.iter().map(|(about, signature)| format!("{about}{signature};\n")).collect::<Vec<_>>().join("\n");
    text + "\n#ifdef __cplusplus\n}\n#endif\n\n#endif\n"
}

/// The origin of the header, its content, and its guard.
pub(super) fn opening(names: &Names, of: &Solved, found: &InverseKinematics, origin: &Origin) -> String {
    let upper = &names.upper;
    let class = format!("Inverse kinematics: {}; at most {} solutions.", found.class, found.most);
    let text = said(&crate::emit::head::lines(origin, &of.head().into_iter().chain([class]).collect::<Vec<_>>()));
    // No name of a robot makes a guard of this end: that of a header of functions ends in `_H`.
    let guard = format!("ARMGEN_{upper}_INVERSE_KINEMATICS");
    text + &format!("#ifndef {guard}\n#define {guard}\n\n")
}

/// The target of the arm, in words.
fn reached(target: Target) -> &'static str {
    match target {
        Target::Pose | Target::Planar => "pose",
        Target::Position => "position",
        Target::Pointing => "position and direction",
    }
}

/// The macros and the structs of both headers; `way`: what holds the constants of the loop, in words.
pub(super) fn types(names: &Names, found: &InverseKinematics, way: &str) -> String {
    let Names { robot, upper, real, joints: dof } = names;
    let (most, target) = (found.most, reached(found.target));
    let mut text = said(&[format!("At most so many postures reach a {target}, where they are finitely many.")]);
    text += &format!("#define {upper}_MAX_SOLUTIONS {most}\n\n");
    text += &said(&["What is known of the solutions, `verdict`:".into()]);
    for (number, (name, means)) in VERDICTS.iter().enumerate() {
        let means = means.unwrap_or_else(|| rust::what_is_invalid(found));
        text += &format!("#define {upper}_{} {number} /* {means} */\n", spelled(name));
    }
    let branches = found.branches();
    if !branches.is_empty() {
        let names = branches.iter().map(|name| format!("    \"{name}\"")).collect::<Vec<_>>().join(", \\\n");
        text += "\n";
        text += &said(&rust::meanings(found, way).iter().map(|line| line.trim().to_owned()).collect::<Vec<_>>());
        text += &format!("#define {upper}_BRANCHES {{ \\\n{names}}}\n");
    }
    let [entries, entry] = rust::entries_of_postures(found);
    text + &format!(
        "\n/* One posture. */\ntypedef struct {{\n    {real} q[{dof}]; /* {entries}: angles in (-pi, pi], rad; lengths, m */\n    \
         uint32_t branch; /* which of the construction's ways leads here */\n    \
         uint32_t is_double; /* 1: two solutions meet here */\n    \
         uint32_t free; /* bit i: {entry} i + 1 has one of many values, which the construction chose */\n}} {robot}_solution;\n\n\
         /* All postures that reach a {target}. */\ntypedef struct {{\n    uint32_t verdict;\n    uint32_t count;\n    \
         {real} miss; /* where there is none: by how much the construction missed, a hint; otherwise how far t is from a rotation */\n    \
         {robot}_solution all[{upper}_MAX_SOLUTIONS]; /* zeros from count on */\n}} {robot}_solutions;\n\n"
    )
}

/// The functions of both headers: documentation and declaration of each.
pub(super) fn functions(names: &Names, found: &InverseKinematics) -> Vec<(String, String)> {
    let Names { robot, real, joints: dof, .. } = names;
    let mut about = vec![
        format!("All {} that take the end effector to the {} of t.", rust::entries_of_postures(found)[0], reached(found.target)),
        format!("t: {}.", rust::about_target(found.target)),
    ];
    about.extend(rust::about_redundancy(found).map(|about| format!("redundancy: {about}.")));
    let redundancy = found.redundancy.as_ref().map_or(String::new(), |_| format!("    {real} redundancy,\n"));
    let mut functions = vec![(
        said(&about),
        format!("void {robot}_inverse_kinematics(\n    const {real} t[4][4],\n{redundancy}    {robot}_solutions *solutions)"),
    )];
    if found.redundancy.is_some() {
        functions.push((
            said(&["The redundancy of a posture, with which it is found again.".into()]),
            format!("{real} {robot}_inverse_kinematics_redundancy(const {real} q[{dof}])"),
        ));
    }
    let [_, entry] = rust::entries_of_postures(found);
    functions.push((
        said(&[format!(
            "Those of the postures that are within the limits of the {entry}s, angles moved by whole turns into them."
        )]),
        format!("void {robot}_within_limits(\n    const {robot}_solutions *solutions,\n    {robot}_solutions *within)"),
    ));
    functions.push((
        said(&["The index of the posture whose largest difference from q is smallest, angles modulo whole turns; -1 if there is none.".into()]),
        format!("int32_t {robot}_nearest_to(\n    const {robot}_solutions *solutions,\n    const {real} q[{dof}])"),
    ));
    functions
}

/// A name of Rust as one of a macro: `NearDouble` as `NEAR_DOUBLE`.
fn spelled(name: &str) -> String {
    let mut text = String::new();
    for c in name.chars() {
        if c.is_ascii_uppercase() && !text.is_empty() {
            text.push('_');
        }
        text.push(c.to_ascii_uppercase());
    }
    text
}

fn wrappers(robot: &str, found: &InverseKinematics, origin: &Origin) -> String {
    let mut numbers = String::new();
    let mut verdicts = String::new();
    for (number, (name, _)) in VERDICTS.iter().enumerate() {
        numbers += &format!("        Verdict::{name} => {number},\n");
        if number + 1 < VERDICTS.len() {
            verdicts += &format!("        {number} => Verdict::{name},\n");
        }
    }
    let (parameter, argument) = if found.redundancy.is_some() { ("redundancy: Real, ", ", redundancy") } else { ("", "") };
    let text = rust::head(origin, &[])
        + &format!(
            r#"// For C. Each wrapper believes what its declaration in the header says of its pointers.

/// One posture, as C has it.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct CSolution {{
    q: [Real; DOF],
    branch: u32,
    is_double: u32,
    free: u32,
}}

/// All postures at a pose, as C has them.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct CSolutions {{
    verdict: u32,
    count: u32,
    miss: Real,
    all: [CSolution; MAX_SOLUTIONS],
}}

fn to_c(solutions: &Solutions) -> CSolutions {{
    let verdict = match solutions.verdict {{
{numbers}    }};
    let all = solutions.all.map(|s| CSolution {{ q: s.q, branch: u32::from(s.branch), is_double: u32::from(s.double), free: s.free }});
    CSolutions {{ verdict, count: solutions.count as u32, miss: solutions.miss, all }}
}}

/// What C wrote may say anything: a count that is too large counts as all, a verdict that is none as `Invalid`.
fn from_c(solutions: &CSolutions) -> Solutions {{
    let verdict = match solutions.verdict {{
{verdicts}        _ => Verdict::Invalid,
    }};
    let all = solutions.all.map(|s| Solution {{ q: s.q, branch: s.branch as u16, double: s.is_double != 0, free: s.free }});
    Solutions {{ verdict, count: (solutions.count as usize).min(MAX_SOLUTIONS), miss: solutions.miss, all }}
}}

/// [`inverse_kinematics`] for C.
///
/// # Safety
/// `t` leads to four rows of four numbers, `solutions` to memory for the struct, both aligned.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn {robot}_inverse_kinematics(t: *const [[Real; 4]; 4], {parameter}solutions: *mut CSolutions) {{
    // SAFETY: the caller promises that t points to such an array; nothing is written meanwhile.
    let value = unsafe {{ inverse_kinematics(&*t{argument}) }};
    // SAFETY: the caller promises that there is memory for the result.
    unsafe {{ solutions.write(to_c(&value)) }}
}}

/// [`Solutions::within_limits`] for C.
///
/// # Safety
/// Both pointers lead to the struct, aligned; they may lead to the same one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn {robot}_within_limits(solutions: *const CSolutions, within: *mut CSolutions) {{
    // SAFETY: the caller promises that the pointer leads to the struct, all of it written.
    let value = unsafe {{ from_c(&*solutions) }}.within_limits();
    // SAFETY: the caller promises that there is memory for the result.
    unsafe {{ within.write(to_c(&value)) }}
}}

/// [`Solutions::nearest_to`] for C: an index, -1 for none.
///
/// # Safety
/// `solutions` leads to the struct, `q` to as many numbers as there are joints, both aligned.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn {robot}_nearest_to(solutions: *const CSolutions, q: *const [Real; DOF]) -> i32 {{
    // SAFETY: the caller promises that the pointer leads to the struct, all of it written.
    let value = unsafe {{ from_c(&*solutions) }};
    // SAFETY: the caller promises that q points to an array of this length.
    let nearest = value.nearest_to(unsafe {{ &*q }});
    let place = nearest.and_then(|nearest| value.as_slice().iter().position(|solution| core::ptr::eq(solution, nearest)));
    place.map_or(-1, |place| place as i32)
}}
"#
        );
    if found.redundancy.is_none() {
        return text;
    }
    text + &format!(
        r#"
/// [`inverse_kinematics_redundancy`] for C.
///
/// # Safety
/// `q` leads to as many numbers as there are joints, aligned.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn {robot}_inverse_kinematics_redundancy(q: *const [Real; DOF]) -> Real {{
    // SAFETY: the caller promises that q points to an array of this length.
    inverse_kinematics_redundancy(unsafe {{ &*q }})
}}
"#
    )
}
