//! How generation, operation counts and compile times grow with the joints of a chain.
//!
//! `cargo run --release -p armgen-codegen --example scaling [-- [--figure FILE] [--functions NAMES] [--generation] [JOINTS or ROBOT.yaml ...]]`
//! generates chains of 2, 4, 8, 16 and 32 revolute joints, or the requested chains and robots. Chains have twist angles pi/2, 0,
//! -pi/2, 0 in turn and full inertias. The program compiles each emitted module by `rustc` at opt-level 3 in one codegen unit,
//! prints a table and draws it.
//!
//! `r7` is a chain of 7 revolute joints whose angles are all decimals, `p10` a chain of 10 prismatic joints. `rrp9` has 9 joints:
//! revolute, revolute, prismatic in turn. `--generation` compiles nothing.

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use armgen_codegen::program::{Cost, Trig};
use armgen_codegen::schedule::{Options, Selection};
use armgen_codegen::source::Source;
use armgen_codegen::{emit, validate, Model};

/// A chain of n joints, `kinds` in turn, whose links have all ten inertial parameters; its angles are decimals if they are `general`.
fn chain(n: usize, kinds: &str, general: bool) -> String {
    let mut text = format!("name: chain{n}\nconvention: modified\ngravity: [0, 0, -9.81]\njoints:\n");
    for (i, kind) in kinds.chars().cycle().take(n).enumerate() {
        let kind = if kind == 'r' { "revolute" } else { "prismatic" };
        let right = || (["pi/2", "0", "-pi/2", "0"][i % 4].to_string(), "0".to_string());
        let (alpha, theta) =
            if general { (format!("0.{}", 17 + 10 * (i % 8) + i / 8), format!("0.{}", 300 + 7 * i)) } else { right() };
        // Numbers that differ from link to link and have no pattern to exploit.
        let vary = |k: usize| ((i * 37 + k * 61) % 97) as f64 / 97.0;
        let fixed = |x: f64| format!("{x:.4}");
        writeln!(
            text,
            "  - {{name: j{i}, type: {kind}, a: {}, alpha: {alpha}, d: {}, theta: {theta}, link: {{mass: {}, com: [{}, {}, {}], \
             inertia: {{xx: {}, yy: {}, zz: {}, xy: {}, xz: {}, yz: {}}}}}}}",
            fixed(0.05 + 0.2 * vary(0)),
            fixed(0.1 + 0.2 * vary(1)),
            fixed(1.0 + 3.0 * vary(2)),
            fixed(0.1 * vary(3) - 0.05),
            fixed(0.1 * vary(4) - 0.05),
            fixed(0.1 * vary(5) - 0.05),
            fixed(0.03 + 0.01 * vary(6)),
            fixed(0.03 + 0.01 * vary(7)),
            fixed(0.03 + 0.01 * vary(8)),
            fixed(0.004 * vary(9) - 0.002),
            fixed(0.004 * vary(10) - 0.002),
            fixed(0.004 * vary(11) - 0.002),
        )
        .expect("text");
    }
    text
}

/// What was measured of one chain.
struct Row {
    arm: String,
    joints: usize,
    generation: Duration,
    memory_mib: f64,
    bytes: usize,
    compilation: Option<Duration>,
    /// Function and operations.
    operations: Vec<(String, usize)>,
}

/// The description that an argument denotes.
fn description(what: &str) -> String {
    let kinds = what.trim_end_matches(|c: char| c.is_ascii_digit());
    match (what[kinds.len()..].parse(), kinds) {
        (Ok(joints), "") => chain(joints, "r", false),
        (Ok(joints), kinds) if kinds.chars().all(|kind| "rp".contains(kind)) => chain(joints, kinds, true),
        _ => std::fs::read_to_string(what).unwrap_or_else(|error| panic!("{what}: {error}")),
    }
}

fn measure(what: &str, selection: &Selection, compiled: bool, folder: &Path) -> Row {
    let text = description(what);
    let started = processor_time(OWN);
    let source = Source::new("robot.yaml", text);
    let (valid, diagnostics) = validate::read(&source);
    let (manipulator, _) =
        valid.unwrap_or_else(|| panic!("{}", diagnostics.render(&source, armgen_codegen::diagnostic::Colour::Never)));
    let module = armgen_codegen::schedule::module(
        &Model::new(manipulator),
        &Options { trig: Trig::Std, functions: selection.clone(), ..Options::default() },
    );
    let text = emit::rust::print(&module, &emit::Origin::of(&source), &emit::Notes::default());
    let generation = processor_time(OWN) - started;
    let operations = module.functions.iter().map(|function| {
        let cost = Cost::of(function);
        (function.name(), cost.mul + cost.add + cost.div)
    });
    let operations = operations.collect();
    let joints = module.joints.len();
    let path = folder.join(format!("armgen_scaling_{}_{joints}.rs", std::process::id()));
    std::fs::write(&path, &text).expect("the folder for temporary files can be written");
    let compilation = if compiled { compile(&path) } else { None };
    // Where there is no compiler, there is no object file.
    let _ = std::fs::remove_file(path.with_extension("o"));
    std::fs::remove_file(&path).expect("what was written can be removed");
    Row { arm: what.into(), joints, generation, memory_mib: peak_memory(), bytes: text.len(), compilation, operations }
}

/// The most memory that this process has had, MiB; NaN where the system does not report it.
fn peak_memory() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    line.and_then(|rest| rest.trim().strip_suffix(" kB")?.parse::<f64>().ok()).map_or(f64::NAN, |kib| kib / 1024.0)
}

/// CPU time of the compiler, if it is installed.
fn compile(path: &Path) -> Option<Duration> {
    let before = processor_time(CHILDREN);
    let status = Command::new("rustc")
        .args(["--edition", "2021", "--crate-type", "lib", "--emit", "obj", "-C", "opt-level=3", "-C", "codegen-units=1", "-o"])
        .arg(path.with_extension("o"))
        .arg(path)
        .status()
        .ok()?;
    assert!(status.success(), "the emitted module compiles");
    Some(processor_time(CHILDREN) - before)
}

/// Where the line `/proc/self/stat` holds the user's time of this process after its name, and that of those that it has waited for.
const OWN: usize = 11;
const CHILDREN: usize = 13;

/// CPU time, of the user and of the system, where the system reports it; zero otherwise.
fn processor_time(place: usize) -> Duration {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let fields: Vec<&str> = stat.rsplit(')').next().unwrap_or_default().split_whitespace().collect();
    let ticks = |at: usize| fields.get(at).and_then(|field| field.parse::<u64>().ok()).unwrap_or(0);
    // In hundredths of a second.
    Duration::from_millis(10 * (ticks(place) + ticks(place + 1)))
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    let mut compiled = true;
    let (mut figure, mut selection, mut robots): (Option<PathBuf>, _, Vec<String>) = (None, Selection::ALL, Vec::new());
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--figure" => figure = arguments.next().map(PathBuf::from),
            "--generation" => compiled = false,
            "--functions" => {
                let names = arguments.next().unwrap_or_default();
                selection = Selection::named(names.split(',')).unwrap_or_else(|message| panic!("{message}"));
            }
            robot => robots.push(robot.into()),
        }
    }
    if robots.is_empty() {
        robots = ["2", "4", "8", "16", "32"].map(String::from).to_vec();
    }
    let folder = std::env::temp_dir();
    let mut rows = Vec::new();
    println!("arm     generation s (CPU)  peak MiB  text KiB  compile s (CPU)  operations in all");
    for robot in robots {
        let row = measure(&robot, &selection, compiled, &folder);
        let total: usize = row.operations.iter().map(|(_, count)| count).sum();
        let compilation = row.compilation.map_or("-".into(), |time| format!("{:.2}", time.as_secs_f64()));
        println!(
            "{:6}  {:18.2}  {:8.0}  {:8.0}  {compilation:>15}  {total:17}",
            row.arm,
            row.generation.as_secs_f64(),
            row.memory_mib,
            row.bytes as f64 / 1024.0
        );
        rows.push(row);
    }
    println!("\noperations (multiplications, additions and divisions)");
    for (name, _) in &rows[0].operations {
        let count = |row: &Row| row.operations.iter().find(|(other, _)| other == name).map_or("-".into(), |(_, n)| n.to_string());
        println!("{name:32}{}", rows.iter().map(|row| format!("{:>9}", count(row))).collect::<String>());
    }
    if let Some(path) = figure {
        std::fs::write(&path, draw(&rows)).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    }
}

/// A line of a panel: name, colour, points.
type Curve = (String, &'static str, Vec<(f64, f64)>);

/// Three panels with logarithmic axes: operations, generation, compilation.
fn draw(rows: &[Row]) -> String {
    const COLOURS: [&str; 6] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"];
    const FUNCTIONS: [&str; 6] = [
        "inverse_dynamics",
        "inertia_matrix",
        "coriolis_matrix",
        "base_regressor",
        "inverse_dynamics_derivatives",
        "forward_dynamics_derivatives",
    ];
    let points = |value: &dyn Fn(&Row) -> Option<f64>| -> Vec<(f64, f64)> {
        rows.iter().filter_map(|row| Some((row.joints as f64, value(row)?))).collect()
    };
    let operations: Vec<Curve> = FUNCTIONS
        .iter()
        .zip(COLOURS)
        .map(|(name, colour)| {
            let count = |row: &Row| row.operations.iter().find(|(other, _)| other == name).map(|(_, n)| *n as f64);
            ((*name).to_string(), colour, points(&count))
        })
        .collect();
    let generation = vec![("generation, CPU s".to_string(), COLOURS[0], points(&|row| Some(row.generation.as_secs_f64())))];
    let compilation = vec![("rustc, CPU s".to_string(), COLOURS[1], points(&|row| Some(row.compilation?.as_secs_f64())))];
    let mut svg = String::from(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 1080 380\" font-family=\"sans-serif\" font-size=\"12\">\n\
         <rect width=\"1080\" height=\"380\" fill=\"white\"/>\n",
    );
    panel(&mut svg, 60.0, "operations", &operations);
    panel(&mut svg, 420.0, "time to generate everything", &generation);
    panel(&mut svg, 780.0, "time to compile it at opt-level 3", &compilation);
    svg + "</svg>\n"
}

fn panel(svg: &mut String, left: f64, title: &str, curves: &[Curve]) {
    let (top, width, height) = (40.0, 280.0, 280.0);
    let all = || curves.iter().flat_map(|(_, _, points)| points.iter().copied()).filter(|(x, y)| *x > 0.0 && *y > 0.0);
    let range = |values: Vec<f64>| {
        let low = values.iter().fold(f64::INFINITY, |a, &b| a.min(b)).log10().floor();
        let high = values.iter().fold(f64::NEG_INFINITY, |a, &b| a.max(b)).log10().ceil();
        if low.is_finite() && high > low {
            (low, high)
        } else {
            (0.0, 1.0)
        }
    };
    let (low, high) = range(all().map(|(_, y)| y).collect());
    let (first, last) = (all().map(|(x, _)| x).fold(f64::INFINITY, f64::min), all().map(|(x, _)| x).fold(1.0, f64::max));
    let across = |x: f64| left + width * (x / first).ln() / (last / first).ln().max(1e-9);
    let up = |y: f64| top + height * (high - y.log10()) / (high - low);
    let mut line = |text: String| {
        svg.push_str(&text);
        svg.push('\n');
    };
    line(format!("<text x=\"{left}\" y=\"24\" font-size=\"14\">{title}</text>"));
    line(format!("<rect x=\"{left}\" y=\"{top}\" width=\"{width}\" height=\"{height}\" fill=\"none\" stroke=\"#888\"/>"));
    for power in low as i32..=high as i32 {
        let y = up(10f64.powi(power));
        let label = match power {
            -2..=3 => 10f64.powi(power).to_string(),
            _ => format!("10<tspan dy=\"-5\" font-size=\"9\">{power}</tspan>"),
        };
        line(format!("<line x1=\"{left}\" x2=\"{}\" y1=\"{y:.1}\" y2=\"{y:.1}\" stroke=\"#ddd\"/>", left + width));
        line(format!("<text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{label}</text>", left - 6.0, y + 4.0));
    }
    let mut joints: Vec<f64> = all().map(|(x, _)| x).collect();
    joints.sort_by(f64::total_cmp);
    joints.dedup();
    for x in joints {
        line(format!("<text x=\"{:.1}\" y=\"{}\" text-anchor=\"middle\">{x}</text>", across(x), top + height + 18.0));
    }
    line(format!("<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">joints</text>", left + width / 2.0, top + height + 36.0));
    // A line that grows with the third power, for comparison, through the first point of the lowest curve.
    if let Some(&(x, y)) = curves.last().and_then(|(_, _, points)| points.first()) {
        let end = (last, y * (last / x).powi(3));
        let cut = if end.1.log10() > high { (x * (10f64.powf(high) / y).cbrt(), 10f64.powf(high)) } else { end };
        line(format!(
            "<line x1=\"{:.1}\" y1=\"{:.1}\" x2=\"{:.1}\" y2=\"{:.1}\" stroke=\"#888\" stroke-dasharray=\"4 4\"/>",
            across(x),
            up(y),
            across(cut.0),
            up(cut.1)
        ));
        line(format!("<text x=\"{:.1}\" y=\"{:.1}\" fill=\"#666\">n³</text>", across(cut.0) - 24.0, up(cut.1) + 16.0));
    }
    for (index, (name, colour, points)) in curves.iter().enumerate() {
        let path: Vec<String> = points.iter().map(|&(x, y)| format!("{:.1},{:.1}", across(x), up(y))).collect();
        line(format!("<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\"/>", path.join(" ")));
        for &(x, y) in points {
            line(format!("<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"3\" fill=\"{colour}\"/>", across(x), up(y)));
        }
        let y = top + height - 10.0 - 15.0 * (curves.len() - 1 - index) as f64;
        line(format!("<text x=\"{}\" y=\"{y}\" text-anchor=\"end\" fill=\"{colour}\">{name}</text>", left + width - 8.0));
    }
}
