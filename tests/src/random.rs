//! Random arms and states from a seed, and a few fixed tricky arms.
//!
//! An arm is the text of a description, so that it goes through everything. The same seed gives the same text everywhere; numbers have
//! few digits, angles are multiples of pi/12 or one of a few general ones. Inertias are Σ-born: for Σ = L L' with a random triangular L
//! the tensor tr(Σ) 1 - Σ is what some real body has (positive, triangle inequality), computed in whole numbers and written exactly.

use std::fmt::Write;

/// A generator of random numbers (SplitMix64: Steele, Lea, Flood, 2014): small, and the same for ever.
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// Starts from a seed.
    pub fn new(seed: u64) -> Self {
        Random(seed)
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Whole number from `low` to `high`, both included.
    pub fn whole(&mut self, low: i64, high: i64) -> i64 {
        low + (self.next() % (high - low + 1) as u64) as i64
    }

    /// True in `percent` of a hundred cases.
    pub fn chance(&mut self, percent: i64) -> bool {
        self.whole(1, 100) <= percent
    }

    /// Real number between `low` and `high`.
    pub fn real(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// One of several texts, each as likely.
    pub fn one_of<'a>(&mut self, choices: &[&'a str]) -> &'a str {
        choices[self.whole(0, choices.len() as i64 - 1) as usize]
    }
}

/// A state of an arm and reference rates and accelerations.
#[derive(Clone, Debug)]
pub struct State {
    /// Joint variables.
    pub q: Vec<f64>,
    /// Joint rates.
    pub dq: Vec<f64>,
    /// Joint accelerations.
    pub ddq: Vec<f64>,
    /// Reference rates.
    pub dqr: Vec<f64>,
    /// Reference accelerations.
    pub ddqr: Vec<f64>,
}

/// A random state of an arm with `dof` joints.
pub fn state(dof: usize, seed: u64) -> State {
    let mut random = Random::new(seed ^ 0x0057_a7e0_0000_0000);
    let mut vector = |bound: f64| (0..dof).map(|_| random.real(-bound, bound)).collect();
    State { q: vector(3.0), dq: vector(2.0), ddq: vector(4.0), dqr: vector(2.0), ddqr: vector(4.0) }
}

/// Fixed arms that combine what is easily got wrong, by name: the files of `tests/robots/`.
pub fn tricky() -> [(&'static str, &'static str); 6] {
    [
        ("everything", include_str!("../robots/everything.yaml")),
        ("modified_prismatic", include_str!("../robots/modified_prismatic.yaml")),
        ("general_angles", include_str!("../robots/general_angles.yaml")),
        ("single_joint", include_str!("../robots/single_joint.yaml")),
        ("base_set", include_str!("../robots/base_set.yaml")),
        ("counterbalance", include_str!("../robots/counterbalance.yaml")),
    ]
}

/// n / 10^digits as an exact decimal.
fn decimal(n: i64, digits: u32) -> String {
    let scale = 10_i64.pow(digits);
    let sign = if n < 0 { "-" } else { "" };
    let text = format!("{sign}{}.{:0width$}", n.abs() / scale, n.abs() % scale, width = digits as usize);
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// A random arm as the text of a description: 1 to 8 joints of both kinds, both conventions, all options.
pub fn arm(seed: u64) -> String {
    let mut random = Random::new(seed);
    let dof = random.whole(1, 8);
    arm_with(&format!("arm_{seed}"), dof as usize, &mut random)
}

/// A random arm of what rows of Denavit and Hartenberg do not need: rows with origin and axis, poses in all writings, a base, tensors in turned
/// axes, attached bodies, armatures, springs, friction with an offset, a cubic and a Stribeck part, and with a part that grows with the load.
pub fn posed_arm(seed: u64) -> String {
    let mut random = Random::new(seed ^ 0x7053_0000);
    let random = &mut random;
    let dof = random.whole(1, 4);
    let urdf = random.chance(70);
    let convention = if urdf { "urdf" } else { random.one_of(&["standard", "modified"]) };
    let regressor = random.one_of(&["standard", "base"]);
    let mut text = format!("name: posed_{seed}\nconvention: {convention}\ngravity: [0, 1.5, -9.81]\nregressor: {regressor}\n");
    if random.chance(50) {
        writeln!(text, "base: {}", pose(random, 2)).expect("text");
    }
    text += "joints:\n";
    for i in 1..=dof {
        let kind = if random.chance(25) { "prismatic" } else { "revolute" };
        writeln!(text, "  - name: joint{i}\n    type: {kind}").expect("text");
        if urdf {
            if random.chance(90) {
                writeln!(text, "    origin: {}", pose(random, 3)).expect("text");
            }
            let axis = random.one_of(&[
                "0, 0, 1",
                "0, 1, 0",
                "-2, 0, 0",
                "0, 0, -1",
                "0, 3, -4",
                "1, -2, 2",
                "1, 1, 0",
                "0.3, 0.2, -0.9",
            ]);
            writeln!(text, "    axis: [{axis}]").expect("text");
        } else {
            let (a, alpha, d, theta) = (length(random), angle(random), length(random), angle(random));
            writeln!(text, "    a: {a}\n    alpha: {alpha}\n    d: {d}\n    theta: {theta}").expect("text");
        }
        let (mass, com, own) = (decimal(random.whole(10, 2000), 2), position(random), turned_inertia(random));
        writeln!(text, "    link:\n      mass: {mass}\n      com: {com}\n      inertia: {own}").expect("text");
        if random.chance(50) {
            text += "      attached:\n";
            for k in 0..random.whole(1, 2) {
                let (mass, com, own) = (decimal(random.whole(0, 200), 2), position(random), turned_inertia(random));
                let origin = pose(random, 3);
                let com = if mass == "0" { "[0, 0, 0]".to_owned() } else { com };
                writeln!(text, "        - {{name: body {k}, origin: {origin}, mass: {mass}, com: {com}, inertia: {own}}}")
                    .expect("text");
            }
        }
        if random.chance(40) {
            writeln!(text, "    armature: {}", decimal(random.whole(1, 90), 3)).expect("text");
        }
        if random.chance(30) {
            let (ratio, inertia) = (random.one_of(&["50", "-62.5"]), decimal(random.whole(1, 50), 5));
            writeln!(text, "    motor: {{ratio: {ratio}, inertia: {inertia}, mass: 0.4, position: [0, 0.1, -0.2]}}")
                .expect("text");
        }
        if random.chance(30) {
            let more = random.one_of(&[
                "",
                "",
                ", offset: -0.75",
                ", cubic: 0.05",
                ", offset: 1/3, cubic: -0.002",
                ", stribeck: {torque: 1.25, velocity: 0.05}",
            ]);
            // Drawn by the seed alone: the other arms stay what they are.
            let load = if seed % 7 == 2 { ", load: 0.08" } else { "" };
            writeln!(text, "    friction: {{viscous: 0.2, coulomb: 3{more}{load}}}").expect("text");
        }
        if random.chance(20) {
            let rest = random.one_of(&["", ", rest: -0.3", ", rest: pi/3"]);
            writeln!(text, "    spring: {{stiffness: {}{rest}}}", decimal(random.whole(1, 9000), 1)).expect("text");
        }
    }
    if random.chance(70) {
        writeln!(text, "tool: {}", pose(random, 2)).expect("text");
    }
    if random.chance(40) {
        writeln!(text, "payload: {{mass: 1.5, com: {}, inertia: {}}}", position(random), turned_inertia(random)).expect("text");
    }
    text
}

/// A pose, or a list of up to `most`.
fn pose(random: &mut Random, most: i64) -> String {
    let count = random.whole(1, most);
    let mut one = || {
        let xyz = random.chance(80).then(|| format!("xyz: [{}, {}, {}]", length(random), length(random), length(random)));
        let turn = random.chance(80).then(|| rotation(random));
        format!("{{{}}}", xyz.into_iter().chain(turn).collect::<Vec<_>>().join(", "))
    };
    let all: Vec<String> = (0..count).map(|_| one()).collect();
    if all.len() == 1 {
        all.concat()
    } else {
        format!("[{}]", all.join(", "))
    }
}

fn rotation(random: &mut Random) -> String {
    match random.whole(0, 6) {
        0 => format!(
            "quat: {}",
            random.one_of(&["[0, 1, 0, 0]", "[0.5, -0.5, 0.5, 0.5]", "[1, 2, -2, 0]", "[0.7, 0.1, 0.2, -0.4]"])
        ),
        1 => format!("axis: {}, angle: {}", random.one_of(&["[0, 0, 2]", "[1, 2, -2]", "[0, 1, 1]"]), angle(random)),
        2 => format!("xyaxes: {}", random.one_of(&["[0, 1, 0, -1, 0, 0]", "[3, 4, 0, 0, 0, 1]", "[1, 2, 2, 0.5, 2, 0]"])),
        _ => format!("rpy: [{}, {}, {}]", angle(random), angle(random), angle(random)),
    }
}

/// A tensor, half of the time in axes of its own.
fn turned_inertia(random: &mut Random) -> String {
    let inertia = inertia(random);
    if random.chance(50) {
        return inertia;
    }
    format!("{}, {}}}", inertia.trim_end_matches('}'), rotation(random))
}

/// A random arm with a given name and number of joints.
pub fn arm_with(name: &str, dof: usize, random: &mut Random) -> String {
    drawn(name, dof, angle, random)
}

/// A random arm with branches: the rows of [`arm_with`], each on the link of a joint before it or on the base, half of these with a mount.
pub fn tree(name: &str, dof: usize, random: &mut Random) -> String {
    let (mut text, mut joints) = (String::new(), 0);
    for line in arm_with(name, dof, random).lines() {
        text.push_str(line);
        text.push('\n');
        if !line.starts_with("    type: ") {
            continue;
        }
        joints += 1;
        if joints == 1 || random.chance(35) {
            continue;
        }
        match random.whole(0, joints - 1) {
            0 => text.push_str("    parent: base\n"),
            parent => writeln!(text, "    parent: joint{parent}").expect("text"),
        }
        if random.chance(50) {
            writeln!(text, "    mount: {}", pose(random, 1)).expect("text");
        }
    }
    if random.chance(40) {
        writeln!(text, "tip: joint{}", random.whole(1, joints)).expect("text");
    }
    text
}

/// A tree as [`tree`] draws it, with motors on any link that spin with any joints.
pub fn tree_with_motors(name: &str, dof: usize, random: &mut Random) -> String {
    let (mut text, mut own) = (String::new(), 0);
    for line in tree(name, dof, random).lines() {
        own += i64::from(line.starts_with("  - name: "));
        text.push_str(line);
        if let Some(motor) = text.ends_with('}').then(|| line.strip_prefix("    motor: {")).flatten() {
            text.pop();
            if random.chance(70) {
                match random.whole(0, dof as i64) {
                    0 => text.push_str(", on: base"),
                    link => write!(text, ", on: joint{link}").expect("text"),
                }
                if !motor.contains("axis:") {
                    let axis = random.one_of(&["[0, 0, 1]", "[-1, 0, 0]", "[0, 3, 4]"]);
                    write!(text, ", axis: {axis}").expect("text");
                }
            }
            let others: Vec<i64> = (1..=dof as i64).filter(|&joint| joint != own && random.chance(40)).collect();
            let factors = others.iter().map(|joint| format!("joint{joint}: {}", random.one_of(&["-1", "2.5", "1/3", "-80"])));
            let factors: Vec<String> = factors.collect();
            if !factors.is_empty() {
                write!(text, ", coupling: {{{}}}", factors.join(", ")).expect("text");
            }
            text.push('}');
        }
        text.push('\n');
    }
    text
}

/// An arm as [`arm_with`] draws it, with angles that are decimals: no sine or cosine has roots.
pub fn arm_with_general_angles(name: &str, dof: usize, random: &mut Random) -> String {
    drawn(name, dof, general_angle, random)
}

/// A chain of prismatic joints in general directions, with general bodies.
pub fn slides(name: &str, dof: usize, random: &mut Random) -> String {
    let mut text = format!("name: {name}\nconvention: standard\ngravity: [0.1, -0.2, -9.81]\njoints:\n");
    for i in 0..dof {
        let mut of = |low: i64, high: i64| decimal(random.whole(low, high), 3);
        let (alpha, theta) = (of(-1500, 1500), of(-1500, 1500));
        let (a, d, mass) = (of(-400, 400), of(-400, 400), of(500, 9000));
        let (x, y, z) = (of(-200, 200), of(-200, 200), of(-200, 200));
        writeln!(
            text,
            "  - {{name: j{i}, type: prismatic, a: {a}, alpha: {alpha}, d: {d}, theta: {theta}, link: {{mass: {mass}, com: [{x}, {y}, {z}], \
             inertia: {{xx: 0.1, yy: 0.11, zz: 0.12, xy: 0.003, xz: -0.002, yz: 0.004}}}}}}"
        )
        .expect("text");
    }
    text
}

/// A chain of joints, `r` revolute and `p` prismatic, whose angles are decimals that differ from joint to joint.
pub fn chain_with_general_angles(joints: &str) -> String {
    let mut text = format!("name: chain_{joints}\nconvention: standard\ngravity: [1, 2, -9.81]\njoints:\n");
    for (i, kind) in (0i64..).zip(joints.chars()) {
        let kind = if kind == 'r' { "revolute" } else { "prismatic" };
        let (alpha, theta) = (decimal(17 + 10 * (i % 8) + i / 8, 2), decimal(300 + 7 * i, 3));
        let (a, d, mass, y) = (decimal(10 + i, 2), decimal(20 + i, 2), decimal(10 + i, 1), decimal(20 + i, 2));
        writeln!(
            text,
            "  - {{name: j{i}, type: {kind}, a: {a}, alpha: {alpha}, d: {d}, theta: {theta}, link: {{mass: {mass}, com: [0.1, {y}, 0.3], \
             inertia: {{xx: 1, yy: 1.1, zz: 1, xy: 0.01, xz: 0.02, yz: 0.03}}}}}}"
        )
        .expect("text");
    }
    text
}

/// An arm with angles as `angle` draws them.
fn drawn(name: &str, dof: usize, angle: fn(&mut Random) -> String, random: &mut Random) -> String {
    let convention = random.one_of(&["standard", "modified"]);
    let gravity = random.one_of(&["[0, 0, -9.81]", "[0, -9.81, 0]", "[1.5, -2.25, 9.5]", "[0, 0, 0]"]);
    // Named quantities, filled in as they come.
    let mut parameters: Vec<(String, String)> = Vec::new();
    let named = random.chance(40);
    let mut joints = String::new();
    for i in 1..=dof {
        joint(&mut joints, i, i == dof, named, &mut parameters, angle, random);
    }
    let mut tail = String::new();
    if random.chance(50) {
        let (xyz, rpy) = (position(random), [angle(random), angle(random), angle(random)].join(", "));
        write!(tail, "tool: {{xyz: {xyz}, rpy: [{rpy}]}}\n\n").expect("text");
    }
    if random.chance(40) {
        let mut mass = decimal(random.whole(1, 500), 2);
        if named {
            parameters.push(("load".to_owned(), std::mem::replace(&mut mass, "load".to_owned())));
        }
        let (com, inertia) = (position(random), inertia(random));
        write!(tail, "payload: {{mass: {mass}, com: {com}, inertia: {inertia}}}\n\n").expect("text");
    }
    let names: Vec<&str> = parameters.iter().map(|(name, _)| name.as_str()).collect();
    let regressor = match random.whole(0, 2) {
        0 if !names.is_empty() => format!("[{}]", names.join(", ")),
        1 => "base".to_owned(),
        _ => "standard".to_owned(),
    };
    let mut text = format!("name: {name}\nconvention: {convention}\ngravity: {gravity}\n\n");
    if !parameters.is_empty() {
        text += "parameters:\n";
        for (name, value) in &parameters {
            writeln!(text, "  {name}: {value}").expect("text");
        }
        text += "\n";
    }
    write!(text, "joints:\n{joints}\n{tail}regressor: {regressor}\n").expect("text");
    text
}

fn joint(
    text: &mut String,
    i: usize,
    last: bool,
    named: bool,
    parameters: &mut Vec<(String, String)>,
    angle: fn(&mut Random) -> String,
    random: &mut Random,
) {
    let mut name = |what: String, value: String| {
        if !named {
            return value;
        }
        parameters.push((what.clone(), value));
        what
    };
    let prismatic = random.chance(25);
    let kind = if prismatic { "prismatic" } else { "revolute" };
    let (a, d) = (length(random), length(random));
    let (alpha, theta) = (angle(random), angle(random));
    writeln!(text, "  - name: joint{i}\n    type: {kind}\n    a: {a}\n    alpha: {alpha}\n    d: {d}\n    theta: {theta}")
        .expect("text");
    // A link without mass leaves B regular where a rotor resists its joint.
    let massless = !last && random.chance(15);
    if massless {
        text.push_str("    link: {mass: 0}\n");
    } else {
        let mass = name(format!("m{i}"), decimal(random.whole(10, 2000), 2));
        let (com, inertia) = (position(random), inertia(random));
        writeln!(text, "    link: {{mass: {mass}, com: {com}, inertia: {inertia}}}").expect("text");
    }
    if massless || random.chance(50) {
        let ratio = random.one_of(&["1", "50", "-62.5", "100", "0.5"]);
        let inertia = name(format!("Im{i}"), decimal(random.whole(1, 50), 5));
        write!(text, "    motor: {{ratio: {ratio}, inertia: {inertia}").expect("text");
        if random.chance(40) {
            let (mass, position) = (decimal(random.whole(1, 300), 2), position(random));
            write!(text, ", mass: {mass}, position: {position}").expect("text");
        }
        if random.chance(40) {
            let axis = random.one_of(&["[1, 0, 0]", "[0, 0, -1]", "[0, 1, 1]", "[3, 0, 4]", "[1, -2, 0.5]"]);
            write!(text, ", axis: {axis}").expect("text");
        }
        if random.chance(50) {
            let viscous = name(format!("Fm{i}"), decimal(random.whole(1, 90), 5));
            write!(text, ", viscous: {viscous}").expect("text");
        }
        text.push_str("}\n");
    }
    if random.chance(40) {
        let viscous = decimal(random.whole(0, 200), 2);
        let coulomb = name(format!("Fc{i}"), decimal(random.whole(0, 300), 2));
        writeln!(text, "    friction: {{viscous: {viscous}, coulomb: {coulomb}}}").expect("text");
    }
}

fn length(random: &mut Random) -> String {
    if random.chance(35) {
        return "0".to_owned();
    }
    decimal(random.whole(-120, 120), 2)
}

fn position(random: &mut Random) -> String {
    let mut coordinate = || decimal(random.whole(-300, 300), 3);
    format!("[{}, {}, {}]", coordinate(), coordinate(), coordinate())
}

fn angle(random: &mut Random) -> String {
    const RIGHT: [&str; 5] = ["0", "pi/2", "-pi/2", "pi", "deg(90)"];
    const ROOTS: [&str; 6] = ["pi/3", "-pi/4", "5*pi/12", "deg(30)", "3*pi/4", "-deg(105)"];
    const GENERAL: [&str; 5] = ["0.7", "-1.2", "pi/5", "deg(37)", "2.9"];
    match random.whole(0, 9) {
        0..=6 => random.one_of(&RIGHT),
        7..=8 => random.one_of(&ROOTS),
        _ => random.one_of(&GENERAL),
    }
    .to_owned()
}

/// A decimal other than 0, between -3.2 and 3.2.
fn general_angle(random: &mut Random) -> String {
    let size = random.whole(1, 320);
    decimal(if random.chance(50) { -size } else { size }, 2)
}

/// tr(Σ) 1 - Σ, Σ = L L', in units of 1e-4 kg m².
fn inertia(random: &mut Random) -> String {
    let mut l = [[0i64; 3]; 3];
    for i in 0..3 {
        for j in 0..i {
            l[i][j] = random.whole(-20, 20);
        }
        l[i][i] = random.whole(1, 40);
    }
    let sigma = |i: usize, j: usize| (0..3).map(|k| l[i][k] * l[j][k]).sum::<i64>();
    let trace = sigma(0, 0) + sigma(1, 1) + sigma(2, 2);
    let diagonal = |i: usize| decimal(trace - sigma(i, i), 4);
    let mixed = |i: usize, j: usize| decimal(-sigma(i, j), 4);
    format!(
        "{{xx: {}, yy: {}, zz: {}, xy: {}, xz: {}, yz: {}}}",
        diagonal(0),
        diagonal(1),
        diagonal(2),
        mixed(0, 1),
        mixed(0, 2),
        mixed(1, 2)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_seed_gives_one_text() {
        assert_eq!(arm(7), arm(7));
        assert_ne!(arm(7), arm(8));
        // The first numbers of SplitMix64 from 0, as published.
        let mut random = Random::new(0);
        assert_eq!([random.next(), random.next()], [0xe220_a839_7b1d_cdaf, 0x6e78_9e6a_a1b9_65f4]);
    }

    #[test]
    fn every_option_occurs() {
        let all: String = (0..200).map(arm).collect();
        for option in [
            "standard",
            "modified",
            "revolute",
            "prismatic",
            "tool:",
            "payload:",
            "motor:",
            "axis:",
            "position:",
            "viscous:",
            "coulomb:",
            "parameters:",
            "regressor: base",
            "regressor: [",
            "regressor: standard",
            "mass: 0}",
            "0.7",
            "pi/3",
            "joint8",
            "[0, 0, 0]\n",
        ] {
            assert!(all.contains(option), "{option} never occurs");
        }
    }

    #[test]
    fn decimals() {
        assert_eq!([decimal(-5, 2), decimal(120, 2), decimal(0, 3), decimal(1234, 4)], ["-0.05", "1.2", "0", "0.1234"]);
    }
}
