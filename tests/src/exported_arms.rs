//! Random arms with the numbers of real files, from a seed: what exporters of CAD programs and people with data sheets write.
//!
//! Right angles stand by name, with 4 to 10 decimals, as floats, or are off by 1e-8 to 1e-2. Lengths have 2 to 12 digits, are zero, or dust of
//! 1e-9 to 1e-4. Axes lie along an axis of the frame, have dust in another component, a general direction, or no unit length.
//! Every description is valid: masses are positive, tensors are those of solid bodies.

use std::f64::consts::PI;
use std::fmt::Write;

use crate::random::Random;

/// Joints that carry the arm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Before {
    /// The arm is fixed to the ground.
    Nothing,
    /// A rail along x.
    Rail,
    /// Slides along x and y and a turn about z: a mobile base.
    Mobile,
}

impl Before {
    /// Its joints: type and axis.
    pub fn joints(self) -> &'static [(&'static str, &'static str)] {
        const ALL: [(&str, &str); 3] = [("prismatic", "[1, 0, 0]"), ("prismatic", "[0, 1, 0]"), ("revolute", "[0, 0, 1]")];
        match self {
            Before::Nothing => &[],
            Before::Rail => &ALL[..1],
            Before::Mobile => &ALL,
        }
    }
}

/// The arm of a seed with `low` to `high` joints of its own.
pub fn arm(seed: u64, (low, high): (i64, i64), before: Before) -> String {
    let mut random = Random::new(seed ^ 0x6578_706f_7274);
    let random = &mut random;
    let convention = if before == Before::Nothing { random.one_of(&["urdf", "standard", "modified"]) } else { "urdf" };
    let mut text = format!("name: exported_{seed}\nconvention: {convention}\ngravity: [0, 0, -9.81]\njoints:\n");
    let slides = before.joints();
    for (i, (kind, axis)) in slides.iter().enumerate() {
        let mass = if i + 1 < slides.len() { random.one_of(&["0", "30", "300"]) } else { "30" };
        writeln!(
            text,
            "  - {{name: base_{i}, type: {kind}, axis: {axis}, link: {{mass: {mass}, inertia: {{xx: 1, yy: 1, zz: 1}}}}}}"
        )
        .expect("text");
    }
    for i in 0..random.whole(low, high) {
        let kind = if random.chance(20) { "prismatic" } else { "revolute" };
        let row = if convention == "urdf" {
            let (xyz, rpy) = ([(); 3].map(|()| length(random)).join(", "), [(); 3].map(|()| angle(random)).join(", "));
            format!("origin: {{xyz: [{xyz}], rpy: [{rpy}]}}, axis: {}", axis(random))
        } else {
            let (a, alpha, d, theta) = (length(random), angle(random), length(random), angle(random));
            format!("a: {a}, alpha: {alpha}, d: {d}, theta: {theta}")
        };
        writeln!(text, "  - {{name: joint_{i}, type: {kind}, {row}, link: {}}}", body(random)).expect("text");
    }
    text
}

/// A number with so many significant digits, in the short way that exporters write it.
fn digits(value: f64, count: usize) -> String {
    let value: f64 = format!("{value:.*e}", count - 1).parse().expect("a number was written");
    if value != 0.0 && value.abs() < 1e-4 {
        format!("{value:e}")
    } else {
        value.to_string()
    }
}

fn sign(random: &mut Random) -> f64 {
    if random.chance(50) {
        1.0
    } else {
        -1.0
    }
}

fn angle(random: &mut Random) -> String {
    const RIGHT: [f64; 6] = [0.0, PI / 2.0, -PI / 2.0, PI, -PI, PI / 4.0];
    let right = RIGHT[random.whole(0, 5) as usize];
    match random.whole(1, 100) {
        ..=25 => random.one_of(&["0", "pi/2", "-pi/2", "pi", "pi/4", "-pi/3"]).to_owned(),
        26..=50 => format!("{right:.*}", [4, 5, 6, 7, 8, 10][random.whole(0, 5) as usize]),
        51..=60 => right.to_string(),
        61..=70 => {
            let off = sign(random) * 10f64.powf(random.real(-8.0, -2.0));
            digits(right + off, [6, 9, 15][random.whole(0, 2) as usize])
        }
        _ => format!("{:.*}", [2, 3, 6][random.whole(0, 2) as usize], random.real(-3.2, 3.2)),
    }
}

fn length(random: &mut Random) -> String {
    match random.whole(1, 100) {
        ..=30 => "0".to_owned(),
        31..=60 => format!("{:.*}", random.whole(2, 4) as usize, random.real(-0.6, 0.6)),
        61..=80 => digits(random.real(-0.6, 0.6), [6, 9, 12][random.whole(0, 2) as usize]),
        _ => digits(sign(random) * 10f64.powf(random.real(-9.0, -4.0)), 6),
    }
}

fn axis(random: &mut Random) -> String {
    match random.whole(1, 100) {
        ..=50 => random.one_of(&["[0, 0, 1]", "[0, 1, 0]", "[1, 0, 0]", "[0, 0, -1]", "[0, -1, 0]"]).to_owned(),
        51..=75 => {
            let (main, mut axis) = (random.whole(0, 2) as usize, ["0"; 3]);
            axis[main] = random.one_of(&["1", "-1"]);
            axis[(main + random.whole(1, 2) as usize) % 3] =
                random.one_of(&["-4.37114e-08", "4.37113883e-08", "1e-06", "-1.22465e-16", "6.12323e-17", "0.000123"]);
            format!("[{}]", axis.join(", "))
        }
        76..=90 => {
            let component = [(); 3].map(|()| format!("{:.3}", sign(random) * random.real(0.1, 1.0)));
            format!("[{}]", component.join(", "))
        }
        _ => {
            let (sine, cosine) = random.real(-3.0, 3.0).sin_cos();
            format!("[0, {cosine:.7}, {sine:.7}]")
        }
    }
}

fn body(random: &mut Random) -> String {
    let drawn = format!("{:.6}", random.real(0.05, 8.0));
    let mass = random.one_of(&["1", "2.5", &drawn]).to_owned();
    let com = [(); 3].map(|()| length(random)).join(", ");
    let [xx, yy, zz] = [(); 3].map(|()| digits(random.real(0.1, 0.12), 6));
    let mut products = String::new();
    if random.chance(50) {
        let [xy, xz, yz] = [(); 3].map(|()| digits(random.real(-0.01, 0.01), 4));
        products = format!(", xy: {xy}, xz: {xz}, yz: {yz}");
    }
    format!("{{mass: {mass}, com: [{com}], inertia: {{xx: {xx}, yy: {yy}, zz: {zz}{products}}}}}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_seed_gives_one_text() {
        assert_eq!(arm(7, (2, 6), Before::Nothing), arm(7, (2, 6), Before::Nothing));
        assert_ne!(arm(7, (2, 6), Before::Nothing), arm(8, (2, 6), Before::Nothing));
    }

    #[test]
    fn every_writing_occurs_and_every_text_is_a_description() {
        let all: Vec<String> = [Before::Nothing, Before::Rail, Before::Mobile]
            .into_iter()
            .flat_map(|before| (0..40).map(move |seed| arm(seed, (2, 6), before)))
            .collect();
        let text = all.concat();
        for writing in ["urdf", "standard", "modified", "prismatic", "pi/2", "-4.37114e-08", "1.5708", "e-", "xy:", "base_2"] {
            assert!(text.contains(writing), "{writing} never occurs");
        }
        for text in all {
            let source = armgen_codegen::source::Source::new("robot.yaml", text.clone());
            let (read, said) = armgen_codegen::description::RobotDescription::parse(&source);
            assert!(read.is_some(), "{}\n{text}", said.render(&source, armgen_codegen::diagnostic::Colour::Never));
        }
    }
}
