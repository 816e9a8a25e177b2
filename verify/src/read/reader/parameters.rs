//! The places of parameters by name, and the parameters of a payload: texts that every module with parameters, or with a payload, has.

use std::collections::BTreeMap;

use super::Constant;

pub(super) const RUST_INDEX: &str = r#"
#[allow(dead_code, clippy::all)]
pub const fn parameter_index(name: &str) -> Option<usize> {
    let mut names: &[&str] = &PARAMETER_NAMES;
    let mut index = 0;
    while let Some((own, others)) = names.split_first() {
        let mut own = own.as_bytes();
        let mut to = name.as_bytes();
        while let (Some((a, x)), Some((b, y))) = (own.split_first(), to.split_first()) {
            if *a != *b {
                break;
            }
            own = x;
            to = y;
        }
        if own.is_empty() && to.is_empty() {
            return Some(index);
        }
        names = others;
        index += 1;
    }
    None
}
"#;

pub(super) const RUST_PAYLOAD: &str = r#"
#[allow(dead_code, clippy::all)]
pub fn payload_parameters(
    mass: Real,
    com: &[Real; 3],
    inertia: &[[Real; 3]; 3],
) -> [Real; 10] {
    let [x, y, z] = *com;
    [
        mass,
        mass * x,
        mass * y,
        mass * z,
        inertia[0][0] + mass * (y * y + z * z),
        inertia[0][1] - mass * (x * y),
        inertia[1][1] + mass * (x * x + z * z),
        inertia[0][2] - mass * (x * z),
        inertia[1][2] - mass * (y * z),
        inertia[2][2] + mass * (x * x + y * y),
    ]
}
"#;

pub(super) const C_PAYLOAD: &str = "\
static inline void robot_payload_parameters(
    robot_real mass,
    const robot_real com[3],
    const robot_real inertia[3][3],
    robot_real parameters[10])
{
    ROBOT_UNFUSED
    const robot_real x = com[0], y = com[1], z = com[2];
    const robot_real xx = inertia[0][0], xy = inertia[0][1], yy = inertia[1][1];
    const robot_real xz = inertia[0][2], yz = inertia[1][2], zz = inertia[2][2];
    parameters[0] = mass;
    parameters[1] = mass * x;
    parameters[2] = mass * y;
    parameters[3] = mass * z;
    parameters[4] = xx + mass * (y * y + z * z);
    parameters[5] = xy - mass * (x * y);
    parameters[6] = yy + mass * (x * x + z * z);
    parameters[7] = xz - mass * (x * z);
    parameters[8] = yz - mass * (y * z);
    parameters[9] = zz + mass * (x * x + y * y);
}
";

pub(super) const PYTHON_INDEX: &str = "PARAMETER_INDEX: Final = {name: index for index, name in enumerate(PARAMETER_NAMES)}\n";

pub(super) const PYTHON_PAYLOAD: &str = "\
def payload_parameters(mass: Any, com: Any, inertia: Any) -> tuple[Any, ...]:
    x, y, z = com[0], com[1], com[2]
    return (
        mass,
        mass * x,
        mass * y,
        mass * z,
        inertia[0][0] + mass * (y * y + z * z),
        inertia[0][1] - mass * (x * y),
        inertia[1][1] + mass * (x * x + z * z),
        inertia[0][2] - mass * (x * z),
        inertia[1][2] - mass * (y * z),
        inertia[2][2] + mass * (x * x + y * y),
    )
";

pub(super) const JAVASCRIPT_INDEX: &str =
    "export const PARAMETER_INDEX = Object.freeze(Object.fromEntries(PARAMETER_NAMES.map((name, index) => [name, index])));\n";

pub(super) const JAVASCRIPT_PAYLOAD: &str = "\
export function payloadParameters(mass, com, inertia) {
    check(\"com\", com, 3);
    check(\"inertia\", inertia, 3);
    inertia.forEach((row) => check(\"a row of inertia\", row, 3));
    const [x, y, z] = com;
    return [
        mass,
        mass * x,
        mass * y,
        mass * z,
        inertia[0][0] + mass * (y * y + z * z),
        inertia[0][1] - mass * (x * y),
        inertia[1][1] + mass * (x * x + z * z),
        inertia[0][2] - mass * (x * z),
        inertia[1][2] - mass * (y * z),
        inertia[2][2] + mass * (x * x + y * y),
    ];
}
";

pub(super) const MATLAB_PAYLOAD: &str = "\
function parameters = payloadParameters(mass, com, inertia)
    x = com(1);
    y = com(2);
    z = com(3);
    parameters = [mass; mass * x; mass * y; mass * z; ...
        inertia(1, 1) + mass * (y * y + z * z); ...
        inertia(1, 2) - mass * (x * y); ...
        inertia(2, 2) + mass * (x * x + z * z); ...
        inertia(1, 3) - mass * (x * z); ...
        inertia(2, 3) - mass * (y * z); ...
        inertia(3, 3) + mass * (x * x + y * y)];
end
";

/// The names of the parameters.
pub(super) fn names(constants: &BTreeMap<String, Constant>) -> Vec<&str> {
    let Some(Constant::Array(names)) = constants.get("PARAMETER_NAMES") else { return Vec::new() };
    names.iter().filter_map(text_of).collect()
}

fn text_of(constant: &Constant) -> Option<&str> {
    match constant {
        Constant::Text(text) => Some(text),
        _ => None,
    }
}

/// Whether they include the ten of a payload.
pub(crate) fn has_payload(constants: &BTreeMap<String, Constant>) -> bool {
    const TEN: [&str; 10] = ["mp", "mcxp", "mcyp", "mczp", "Ixxp", "Ixyp", "Iyyp", "Ixzp", "Iyzp", "Izzp"];
    let names = names(constants);
    names.windows(TEN.len()).any(|ten| {
        let tip = ten[0].strip_suffix(TEN[0]);
        tip.is_some_and(|tip| ten.iter().zip(TEN).all(|(name, end)| name.strip_prefix(tip) == Some(end)))
    })
}
