//! The header that finds all postures by itself: the declarations of `--c-abi`, then the translated module of Rust.
//!
//! Each building block exists once, in Rust (`from_rust`). This file adds, for C alone, the functions of the crate `libm` and the
//! functions for callers.

use super::from_rust::{translated, Translated};
use super::inverse_kinematics::{functions, opening, said, types, Names};
use super::standalone::{EPILOGUE, PROLOGUE};
use crate::emit::plain::of_robot;
use crate::emit::rust;
use crate::emit::Origin;
use crate::inverse_kinematics::{InverseKinematics, Solved};
use crate::kinds::Scalar;

const NUMBERS: &str = include_str!("solver/numbers.h");
const TABLE: &str = include_str!("solver/table.h");
const LARGE_ANGLES: &str = include_str!("solver/large_angles.h");

/// Functions of one scalar.
struct Library {
    opening: &'static str,
    sin_cos: &'static str,
}

const DOUBLE: Library = Library {
    opening: "typedef double robot_real;\ntypedef uint64_t robot_word;\n#define ROBOT_FABS fabs\n#define ROBOT_SQRT sqrt\n#define ROBOT_FLOOR floor\n",
    sin_cos: include_str!("solver/sin_cos_f64.h"),
};

const SINGLE: Library = Library {
    opening: "typedef float robot_real;\ntypedef uint32_t robot_word;\n#define ROBOT_FABS fabsf\n#define ROBOT_SQRT sqrtf\n#define ROBOT_FLOOR floorf\n",
    sin_cos: include_str!("solver/sin_cos_f32.h"),
};

/// The arctangent. Parts that differ between the scalars are marked `@NAME@`.
const ATAN2: &str = include_str!("solver/atan2.h");

/// These parts of the arctangent of doubles, and of floats.
const IN_ATAN2: [(&str, [&str; 2]); 22] = [
    ("real", ["double", "float"]),
    ("f", ["", "f"]),
    (
        "method",
        [
            "(Sun Microsystems 1993): |x| is brought
 * to [0, 7/16] by the tangents of 0, atan 1/2, pi/4, atan 3/2 and pi/2, whose angles are in two parts.",
            "(Sun Microsystems 1993; in single
 * precision by Ian Lance Taylor): |x| is brought to [0, 7/16] by the tangents of 0, atan 1/2, pi/4, atan 3/2 and pi/2, whose angles are in
 * two parts.",
        ],
    ),
    (
        "angles",
        [
            "4.63647609000806093515e-01, 7.85398163397448278999e-01, 9.82793723247329054082e-01, 1.57079632679489655800e+00",
            "4.6364760399e-01f, 7.8539812565e-01f, 9.8279368877e-01f, 1.5707962513e+00f",
        ],
    ),
    (
        "rests",
        [
            "2.26987774529616870924e-17, 3.06161699786838301793e-17, 1.39033110312309984516e-17, 6.12323399573676603587e-17",
            "5.0121582440e-09f, 3.7748947079e-08f, 3.4473217170e-08f, 7.5497894159e-08f",
        ],
    ),
    ("count", ["11", "5"]),
    (
        "coefficients",
        [
            "
        3.33333333333329318027e-01, -1.99999999998764832476e-01, 1.42857142725034663711e-01, -1.11111104054623557880e-01,
        9.09088713343650656196e-02, -7.69187620504482999495e-02, 6.66107313738753120669e-02, -5.83357013379057348645e-02,
        4.97687799461593236017e-02, -3.65315727442169155270e-02, 1.62858201153657823623e-02",
            "3.3333328366e-01f, -1.9999158382e-01f, 1.4253635705e-01f, -1.0648017377e-01f, 6.1687607318e-02f",
        ],
    ),
    ("large", ["73786976294838206464.0", "67108864.0f"]),
    ("large_power", ["2^66", "2^26"]),
    ("small", ["7.450580596923828125e-9", "0.000244140625f"]),
    ("small_power", ["2^-27", "2^-12"]),
    ("odd", ["(a[4] + w * (a[6] + w * (a[8] + w * a[10])))", "a[4]"]),
    ("even", ["(a[3] + w * (a[5] + w * (a[7] + w * a[9])))", "a[3]"]),
    ("turned", ["t * (odd + even) - rest[part]", "(t * (odd + even) - rest[part])"]),
    ("pi", ["3.1415926535897931160e+00", "3.1415927410e+00f"]),
    ("pi_rest", ["1.2246467991473531772e-16", "-8.7422776573e-08f"]),
    ("infinite", ["0x7ff00000u", "0x7f800000u"]),
    ("far_apart", ["64u << 20", "26u << 23"]),
    ("left", ["(uint32_t)(robot_bits(x) >> 63)", "robot_bits(x) >> 31"]),
    ("below", ["(uint32_t)(robot_bits(y) >> 63)", "robot_bits(y) >> 31"]),
    ("high_x", ["(uint32_t)(robot_bits(x) >> 32)", "robot_bits(x)"]),
    ("high_y", ["(uint32_t)(robot_bits(y) >> 32)", "robot_bits(y)"]),
];

/// The header. For an arm without a construction it is a comment with the reason. An error is a fault of this program: a block
/// uses syntax that the translation does not know.
pub fn print(of: &Solved, scalar: Scalar, origin: &Origin) -> Result<String, String> {
    let found = match &of.found {
        Ok(found) => found,
        Err(reason) => {
            let notes = of.head().into_iter().chain([format!("There is no inverse kinematics: {reason}.")]);
            return Ok(said(&crate::emit::head::lines(origin, &notes.collect::<Vec<_>>())));
        }
    };
    let names = Names::of(of, scalar);
    // Everything that is no caller's business has a longer name.
    let (inner, macros) = (format!("{}_ik", names.robot), format!("{}_IK", names.upper));
    let mut wanted = vec!["inverse_kinematics"];
    wanted.extend(found.redundancy.as_ref().map(|_| "inverse_kinematics_redundancy"));
    wanted.extend(["Solutions::within_limits", "Solutions::nearest_to"]);
    let source = rust::items_of_inverse_kinematics(&of.arm, scalar, found);
    let blocks = translated(&source, &wanted, &inner, &macros)
        .map_err(|reason| format!("inverse kinematics of this arm is not there in C, {reason}; this is a fault of armgen"))?;
    let own = |text: &str| of_robot(text, &inner, &macros);

    let mut text = opening(&names, of, found, origin);
    for header in ["float", "math", "stddef", "stdint", "string"] {
        text += &format!("#include <{header}.h>\n");
    }
    text += "#ifndef __cplusplus\n#include <stdbool.h>\n#endif\n\n";
    text += &own(PROLOGUE);
    text += &types(&names, found, &format!("`{inner}_loop`"));
    text += "/*\n * From here on to the functions at the end: the construction and its building blocks.\n */\n\n";
    let library = match scalar {
        Scalar::F64 => DOUBLE,
        Scalar::F32 => SINGLE,
    };
    let Translated { macros, typedefs, tables, functions: bodies } = blocks;
    text += &own(library.opening);
    text += &own(NUMBERS);
    if bodies.contains("_libm_atan2(") {
        let place = usize::from(scalar == Scalar::F32);
        let filled = |text: String, (name, values): &(&str, [&str; 2])| text.replace(&format!("@{name}@"), values[place]);
        text += &own(&IN_ATAN2.iter().fold(ATAN2.to_owned(), filled));
    }
    if bodies.contains("_libm_sin_cos(") {
        text += &own(LARGE_ANGLES);
        text += &own(library.sin_cos);
    }
    if !tables.is_empty() {
        text += &own(TABLE);
    }
    text += &(macros + &typedefs + &tables + &bodies);
    text += &faces(&names, found, &inner);
    text += "\n";
    Ok(text + EPILOGUE)
}

/// The functions that a caller sees.
fn faces(names: &Names, found: &InverseKinematics, inner: &str) -> String {
    let Names { robot, joints, .. } = names;
    let redundancy = if found.redundancy.is_some() { ", redundancy" } else { "" };
    let q = format!("{inner}_real_{joints}_type");
    let (one, all) = (format!("{inner}_posture_{joints}_type"), format!("{inner}_postures_{joints}_{}_type", found.most));
    let text = include_str!("solver/faces.h.txt").replace("@invalid", "4");
    let mut text = text
        .replace("@postures", &all)
        .replace("@posture", &q)
        .replace("@inner", inner)
        .replace("@MACROS", &format!("{}_IK", names.upper));
    text = text.replace("@most", &format!("{}_MAX_SOLUTIONS", names.upper)).replace("@robot", robot);
    for (about, signature) in functions(names, found) {
        let body = if signature.contains("_within_limits(") {
            format!("    const {all} found = INNER_from_c(solutions);\n    const {all} kept = INNER_solutions_within_limits(&found);\n    INNER_to_c(&kept, within);\n")
        } else if signature.contains("_nearest_to(") {
            format!(
                "    const {all} found = INNER_from_c(solutions);\n    const {q} posture = INNER_posture_of(q);\n    \
                 const {one} *nearest = INNER_solutions_nearest_to(&found, &posture);\n    \
                 return nearest == NULL ? -1 : (int32_t)(nearest - found.all.at);\n"
            )
        } else if signature.contains("_redundancy(") {
            format!("    const {q} posture = INNER_posture_of(q);\n    return INNER_inverse_kinematics_redundancy(&posture);\n")
        } else {
            format!(
                "    INNER_real_4x4_type pose;\n    {all} found;\n    int i, j;\n    for (i = 0; i < 4; ++i) {{\n        \
                 for (j = 0; j < 4; ++j) {{\n            pose.at[i].at[j] = t[i][j];\n        }}\n    }}\n    \
                 found = INNER_inverse_kinematics(&pose{redundancy});\n    INNER_to_c(&found, solutions);\n"
            )
        };
        text += &format!("\n{about}static inline {signature}\n{{\n{}}}\n", body.replace("INNER", inner));
    }
    text
}

/// The program that tests the header of an arm with one end effector, for its user: postures found again at the poses of random ones. `None` where
/// there is no construction.
pub fn print_test(of: &Solved, scalar: Scalar, [file, solver]: [&str; 2], origin: &Origin) -> Option<String> {
    let found = of.found.as_ref().ok()?;
    let names = Names::of(of, scalar);
    // Units of rounding times a condition that most random postures have.
    let (near, far, lost) = match scalar {
        Scalar::F64 => ("1e-9", "1e-5", "0"),
        Scalar::F32 => ("2e-3", "0.1", "complete / 500"),
    };
    let redundancy = match found.redundancy {
        None => String::new(),
        Some(_) => format!("{}_inverse_kinematics_redundancy(q), ", names.robot),
    };
    let column = found.target.first_column().to_string();
    let text = include_str!("solver/test.c.txt")
        .replace("@origin", &origin.made_by())
        .replace("@module", file)
        .replace("@solver", solver);
    let text = text.replace("@redundancy", &redundancy).replace("@column", &column).replace("@near", near).replace("@far", far);
    Some(text.replace("@lost", lost).replace("@robot", &names.robot).replace("@ROBOT", &names.upper))
}
