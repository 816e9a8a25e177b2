//! All postures of an arm, computed in process, equal the emitted module's bit by bit.

use std::path::{Path, PathBuf};
use std::process::Command;

use armgen_codegen::source::Source;
use armgen_codegen::{validate, Model, Scalar};
use armgen_evaluate::{programs, solver, Solver, Unfit, Verdict};

use crate::arms::{coupled, few, generated, made_up, robots, workspace};

/// The solver of an arm with the limits of its joints.
type Limited<T> = (Solver<T>, Vec<[T; 2]>);

fn solver_of<T: Bits>(name: &str, text: &str, scalar: Scalar) -> Result<Limited<T>, String> {
    let (valid, diagnostics) = validate::read_for(&Source::new(name, text), scalar);
    let (manipulator, _) = valid.unwrap_or_else(|| panic!("{name}: {diagnostics:?}"));
    let coordinates = manipulator.coordinates();
    let positions = coordinates.iter().map(|coordinate| &coordinate.limits.position);
    let limits = positions.map(|limits| limits.as_ref().map_or(T::UNLIMITED, |limits| limits.each_ref().map(T::nearest)));
    Ok((solver(&manipulator)?, limits.collect()))
}

/// A posture is found again at its pose, and every posture found has the pose, all in process.
#[test]
fn postures_are_found_again() {
    let arms = made_up().into_iter().chain(coupled());
    let all = robots().into_iter().chain(arms.map(|(name, _, _, text)| (name.to_owned(), text)));
    let of_coupled = coupled();
    let names = of_coupled.iter().map(|(name, ..)| *name).filter(|name| *name != "coupled_few");
    let wanted: Vec<&str> =
        ["puma560", "ur5", "scara4", "panda7", "iiwa", "position3r", "table"].into_iter().chain(names).collect();
    let mut seen = 0;
    for (name, text) in all.filter(|(name, _)| wanted.contains(&name.as_str())) {
        let source = Source::new(name.as_str(), text.as_str());
        let (manipulator, places) = validate::read(&source).0.expect("a robot");
        let solver = solver::<f64>(&manipulator).expect("it has inverse kinematics");
        let is_slide = solver.of().prismatic.clone();
        let columns = if solver.of().orientation { 0 } else { 3 };
        let functions = armgen_codegen::schedule::Selection::named(["direct_kinematics"]).expect("a function");
        let options = armgen_codegen::schedule::Options { functions, ..Default::default() };
        let module = armgen_codegen::programs(&Model::new(manipulator), &places, &options).expect("a module");
        let direct = &programs::<f64>(&module)[0];
        let mut workspace = direct.workspace();
        let mut pose_of = |q: &[f64]| {
            let mut t = [[0.0; 4]; 4];
            direct.run(&[q], t.as_flattened_mut(), &mut workspace).expect("a state");
            t
        };
        let mut random = armgen_tests::random::Random::new(5);
        let mut complete = 0;
        for _ in 0..40 {
            let q: Vec<f64> =
                is_slide.iter().map(|slides| if *slides { random.real(-0.5, 0.5) } else { random.real(-3.1, 3.1) }).collect();
            let t = pose_of(&q);
            let found = solver.solve(&t, solver.redundancy(&q)).expect("what is given");
            assert!(!matches!(found.verdict, Verdict::Invalid | Verdict::Unreachable), "{name}: {found:?}");
            let mut nearest = f64::INFINITY;
            let away = |((x, y), slides): ((&f64, &f64), &bool)| {
                let d = (x - y).abs();
                let turn = std::f64::consts::TAU;
                if *slides {
                    d
                } else {
                    (d % turn).min(turn - d % turn)
                }
            };
            for posture in found.q.chunks(q.len()) {
                nearest = nearest.min(posture.iter().zip(&q).zip(&is_slide).map(away).fold(0.0, f64::max));
                let reached = pose_of(posture);
                for (x, y) in reached.iter().zip(&t).flat_map(|(x, y)| x[columns..].iter().zip(&y[columns..])) {
                    assert!((x - y).abs() < 1e-9, "{name}: {posture:?} at {q:?}");
                }
            }
            if found.verdict == Verdict::Complete {
                complete += 1;
                assert!(nearest < 1e-5, "{name}: {q:?} is lost by {nearest}");
                assert!(found.branch.iter().all(|b| solver
                    .of()
                    .branches
                    .get(usize::from(*b))
                    .is_none_or(|name| !name.is_empty())));
                // Next to `q` there is no other posture, two turns away it is the same.
                let number = solver.nearest(&found, &q).expect("a posture");
                let turned = |joint: usize| q[joint] + if is_slide[joint] { 0.0 } else { 4.0 * std::f64::consts::PI };
                let within = solver.within(&found, |joint| [turned(joint) - 1e-4, turned(joint) + 1e-4]);
                assert_eq!((within.len(), within.verdict), (1, found.verdict), "{name}: {q:?}");
                let posture = &found.q[number * q.len()..][..q.len()];
                for (joint, (x, y)) in within.q.iter().zip(posture).enumerate() {
                    assert!((x - turned(joint)).abs() < 1e-5 && away(((x, y), &is_slide[joint])) < 1e-5, "{name}: {q:?}");
                }
                assert_eq!((within.branch[0], solver.nearest(&found, &q[1..])), (found.branch[number], None));
                assert_eq!(solver.within(&found, |_| [f64::NEG_INFINITY, f64::INFINITY]), found);
                assert!(solver.within(&found, |joint| [turned(joint) + 1e-4; 2]).is_empty());
            }
        }
        assert!(complete >= 30, "{name}: {complete}");
        let identity = pose_of(&vec![0.1; is_slide.len()]);
        match solver.of().redundancy {
            Some(_) => assert_eq!(solver.solve(&identity, None), Err(Unfit::Missing)),
            None => assert_eq!(solver.solve(&identity, Some(0.0)), Err(Unfit::Unasked)),
        }
        seen += 1;
    }
    assert_eq!(seen, wanted.len());
}

/// The random numbers of the emitted tests.
const RANDOM: &str = include_str!("../../codegen/tests/inverse_kinematics/random.rs");

/// The program that solves at the poses of the emitted tests and at special ones, and prints each with its postures.
const PROGRAM: &str = r#"
macro_rules! print {
    ($module:ident, $ik:ident, $poses:expr, $solve:expr, $redundancy:expr) => {{
        use $ik::{Real, DOF};
        println!("arm {}", stringify!($module));
        let mut random = Random(1);
        for number in 0..$poses + $poses / 3 {
            let special = number >= $poses;
            let q: [Real; DOF] = std::array::from_fn(|i| {
                let turns = $module::JOINT_IS_REVOLUTE[i];
                let right = special && random.next() % 2 == 0;
                (match (right, turns) {
                    (true, true) => (random.next() % 5) as f64 * std::f64::consts::FRAC_PI_2 - std::f64::consts::PI,
                    (true, false) => 0.0,
                    (false, true) => random.between(-3.1, 3.1),
                    (false, false) => random.between(-0.5, 0.5),
                }) as Real
            });
            let mut t = $module::direct_kinematics(&q);
            let mut r = $redundancy(&q);
            if special {
                match number % 16 {
                    7 => t[0][3] += 3.0,
                    11 => t[2][3] += 1e-7,
                    12 => r = random.between(-1e3, 1e3) as Real,
                    13 => r = Real::NAN,
                    15 => {
                        let at = (random.next() % 12) as usize;
                        t[at / 4][at % 4] = [Real::NAN, Real::INFINITY, -0.0, 1e30, 0.5][(random.next() % 5) as usize];
                    }
                    _ => {}
                }
            }
            let found = $solve(&t, r);
            let mut line = String::new();
            for x in t.iter().flatten().chain([&r, &found.miss]) {
                line += &format!("{:x} ", x.to_bits());
            }
            line += &format!("{}", found.verdict as u32);
            for one in found.as_slice() {
                line += &format!(" {} {} {}", one.branch, u32::from(one.double), one.free);
                for x in &one.q {
                    line += &format!(" {:x}", x.to_bits());
                }
            }
            let nearest = found.nearest_to(&[0.5; DOF]);
            let nearest = nearest.map(std::ptr::from_ref);
            let place = found.as_slice().iter().position(|one| nearest == Some(std::ptr::from_ref(one)));
            line += &format!(" nearest {place:?} within");
            for one in found.within_limits().as_slice() {
                line += &format!(" {}", one.branch);
                for x in &one.q {
                    line += &format!(" {:x}", x.to_bits());
                }
            }
            println!("{line}");
        }
    }};
}
"#;

/// The output of a project of emitted modules.
struct Project {
    folder: PathBuf,
    main: String,
    calls: String,
}

impl Project {
    fn write(&self, path: &str, text: &str) {
        let path = self.folder.join(path);
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("a folder can be made");
        std::fs::write(&path, text).expect("a file can be written");
    }

    /// Whether the arm has inverse kinematics, which is then printed.
    fn add(&mut self, module: &str, text: &str, scalar: Scalar) -> bool {
        let arm = generated(module, text, scalar);
        let ik = arm.inverse_kinematics();
        if !ik.contains("pub fn inverse_kinematics") {
            return false;
        }
        self.write(&format!("src/{module}.rs"), &arm.module);
        self.write(&format!("src/{module}_ik.rs"), &ik);
        self.main += &format!("#[allow(dead_code)]\nmod {module};\n#[allow(dead_code)]\nmod {module}_ik;\n");
        let (solve, redundancy) = if ik.contains("redundancy: Real") {
            let solve = format!("|t: &_, r| {module}_ik::inverse_kinematics(t, r)");
            (solve, format!("{module}_ik::inverse_kinematics_redundancy"))
        } else {
            (format!("|t: &_, _| {module}_ik::inverse_kinematics(t)"), format!("|_: &[{module}_ik::Real; {module}_ik::DOF]| 0.0"))
        };
        // Roots of equations that are sampled take long.
        let poses = if ik.contains("BRANCHES: [&str; 0]") { 60 } else { 300 };
        self.calls += &format!("    print!({module}, {module}_ik, {poses}, {solve}, {redundancy});\n");
        true
    }

    fn run(self) -> String {
        let manifest =
            "[package]\nname = \"postures\"\nversion = \"1.0.0\"\nedition = \"2021\"\n\n[dependencies]\nlibm = \"0.2\"\n\n\
                        [workspace]\n\n[profile.dev]\nopt-level = 1\ndebug = false\nincremental = false\n";
        self.write("Cargo.toml", manifest);
        self.write("Cargo.lock", &std::fs::read_to_string(workspace().join("Cargo.lock")).expect("the lock file"));
        self.write("src/main.rs", &format!("{RANDOM}{PROGRAM}\n{}\nfn main() {{\n{}}}\n", self.main, self.calls));
        let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let mut command = Command::new(cargo);
        command.args(["run", "--quiet", "--offline"]).current_dir(&self.folder);
        let output = command.env("CARGO_TARGET_DIR", self.folder.join("target")).output().expect("cargo starts");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).expect("it prints text")
    }
}

/// A scalar by its bits.
trait Bits: armgen_evaluate::Scalar {
    const UNLIMITED: [Self; 2];
    const HALF: Self;
    fn from_hex(text: &str) -> Self;
    fn hex(self) -> String;
}

impl Bits for f64 {
    const UNLIMITED: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];
    const HALF: f64 = 0.5;
    fn from_hex(text: &str) -> f64 {
        f64::from_bits(u64::from_str_radix(text, 16).expect("bits"))
    }
    fn hex(self) -> String {
        format!("{:x}", self.to_bits())
    }
}

impl Bits for f32 {
    const UNLIMITED: [f32; 2] = [f32::NEG_INFINITY, f32::INFINITY];
    const HALF: f32 = 0.5;
    fn from_hex(text: &str) -> f32 {
        f32::from_bits(u32::from_str_radix(text, 16).expect("bits"))
    }
    fn hex(self) -> String {
        format!("{:x}", self.to_bits())
    }
}

/// Solves at every pose of the lines, compares the printed postures, and returns their number.
fn compare<T: Bits>(name: &str, (solver, limits): &Limited<T>, lines: &[&str]) -> usize {
    let mut postures = 0;
    for line in lines {
        let words: Vec<&str> = line.split(' ').collect();
        let t: [[T; 4]; 4] = std::array::from_fn(|i| std::array::from_fn(|j| T::from_hex(words[4 * i + j])));
        let redundancy = solver.of().redundancy.is_some().then(|| T::from_hex(words[16]));
        let found = solver.solve(&t, redundancy).expect("what is given");
        let mut own = format!("{} {}", found.miss.hex(), found.verdict as u32);
        for (i, q) in found.q.chunks(solver.of().prismatic.len()).enumerate() {
            own += &format!(" {} {} {}", found.branch[i], u32::from(found.double[i]), found.free[i]);
            q.iter().for_each(|x| own += &format!(" {}", x.hex()));
        }
        own += &format!(" nearest {:?} within", solver.nearest(&found, &vec![T::HALF; limits.len()]));
        let within = solver.within(&found, |joint| limits[joint]);
        for (branch, q) in within.branch.iter().zip(within.q.chunks(limits.len())) {
            own += &format!(" {branch}");
            q.iter().for_each(|x| own += &format!(" {}", x.hex()));
        }
        assert_eq!(own, words[17..].join(" "), "{name}: at {t:?}, {redundancy:?}");
        postures += found.len();
    }
    postures
}

fn in_both_scalars(name: &str) -> bool {
    let closed = ["few_rrr_elbow", "few_rrr_wrist", "few_rrp", "few_4r", "few_5r", "few_5r_wrist"];
    ["puma560", "scara4", "parallel", "general", "position3r", "panda7", "table"].contains(&name) || closed.contains(&name)
}

/// A few arms in each project, whose modules compile in parallel.
fn have_the_bits_of_emitted_modules(folder: &str, arms: Vec<(String, String)>) {
    for (number, arms) in arms.chunks(8).enumerate() {
        has_the_bits(&format!("{folder}_{number}"), arms);
    }
}

fn has_the_bits(folder: &str, arms: &[(String, String)]) {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(folder);
    let mut project = Project { folder, main: String::new(), calls: String::new() };
    let mut all = Vec::new();
    for (name, text) in arms {
        for (module, scalar) in [(name.clone(), Scalar::F64), (format!("{name}_f32"), Scalar::F32)] {
            if scalar == Scalar::F64 || in_both_scalars(name) {
                let has = project.add(&module, text, scalar);
                assert_eq!(has, solver_of::<f64>(name, text, Scalar::F64).is_ok(), "{name}");
                all.extend(has.then_some((module, text, scalar)));
            }
        }
    }
    let printed = project.run();
    let mut sections = printed.split("arm ").skip(1);
    for (module, text, scalar) in &all {
        let section: Vec<&str> = sections.next().expect("an arm that was printed").lines().collect();
        assert_eq!(section[0], module);
        let postures = match scalar {
            Scalar::F32 => compare(module, &solver_of::<f32>(module, text, *scalar).expect("a solver"), &section[1..]),
            _ => compare(module, &solver_of::<f64>(module, text, *scalar).expect("a solver"), &section[1..]),
        };
        println!("{module}: {postures} postures at {} poses", section.len() - 1);
        assert!(section.len() > 60 && postures > 60, "{module}: {postures}");
    }
    assert!(sections.next().is_none());
}

#[test]
#[ignore = "wide"]
fn every_class_has_the_bits_of_its_emitted_module() {
    let made = made_up().into_iter().map(|(name, _, _, text)| (name.to_owned(), text));
    have_the_bits_of_emitted_modules("postures", robots().into_iter().chain(made).collect());
}

#[test]
#[ignore = "wide"]
fn fewer_joints_than_rows_have_the_bits_of_their_emitted_modules() {
    have_the_bits_of_emitted_modules("postures_few", few());
}
