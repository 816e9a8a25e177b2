//! The figures of docs/inverse-kinematics.md: the eight postures of the Puma at one pose, and how many postures the UR5 has over a slice of its
//! workspace. A test draws them and holds them against the files; `INSTA_UPDATE=always` writes the files.

use std::fmt::Write;
use std::path::Path;

use super::{postures_puma560_f64_ik, postures_ur5_f64_ik, puma560, ur5};

const INK: &str = "#1a1a1a";

fn page(width: u32, height: u32, body: &str) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
         font-family=\"Helvetica, Arial, 'Liberation Sans', sans-serif\" fill=\"{INK}\">\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n{body}</svg>\n"
    )
}

fn text(x: f64, y: f64, size: f64, anchor: &str, said: &str) -> String {
    format!("<text x=\"{x:.1}\" y=\"{y:.1}\" font-size=\"{size}\" text-anchor=\"{anchor}\">{said}</text>\n")
}

fn stroke(points: &[[f64; 2]], colour: &str, width: f64) -> String {
    let mut d = String::new();
    for (i, [x, y]) in points.iter().enumerate() {
        let _ = write!(d, "{}{x:.1} {y:.1}", if i == 0 { "M" } else { "L" });
    }
    format!(
        "<path d=\"{d}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\" stroke-linejoin=\"round\" stroke-linecap=\"round\"/>\n"
    )
}

/// The Puma at the pose of one posture, in each of the eight that have it, seen obliquely.
fn eight_postures() -> String {
    let t = puma560::direct_kinematics(&[1.5, 0.5, -0.75, 0.6, 1.0, 0.3]);
    let found = postures_puma560_f64_ik::inverse_kinematics(&t);
    assert!(found.verdict == postures_puma560_f64_ik::Verdict::Complete && found.count == 8, "{found:?}");
    let (across, down, cell) = (4, 2, [240.0, 300.0]);
    let mut body = text(480.0, 24.0, 15.0, "middle", "All postures of the Puma 560 at one pose");
    for (i, solution) in found.as_slice().iter().enumerate() {
        let (column, row) = (i % across, i / across);
        let (x0, y0) = ((column as f64 + 0.5) * cell[0], (row as f64 + 1.0) * cell[1] - 10.0);
        // From the front right above: x to the lower left, y to the right, z up.
        let seen = |p: [f64; 3]| {
            let [x, y, z] = p;
            [x0 + 150.0 * (0.92 * y - 0.45 * x) - 25.0, y0 - 150.0 * (0.95 * z - 0.28 * x - 0.10 * y) - 8.0]
        };
        let origin = |f: &[[f64; 4]; 4]| [f[0][3], f[1][3], f[2][3]];
        let mut ground = Vec::new();
        for [x, y] in [[-0.3, -0.3], [0.3, -0.3], [0.3, 0.3], [-0.3, 0.3], [-0.3, -0.3]] {
            ground.push(seen([x, y, 0.0]));
        }
        body += &stroke(&ground, "#d9d9d9", 1.0);
        let mut points = vec![[0.0; 3]];
        let frames = puma560::link_frames(&solution.q);
        // Along the common normals of Denavit and Hartenberg: from an origin along its z axis, then to the next.
        for next in frames.iter() {
            let last = *points.last().expect("the base is one");
            let to = origin(next);
            let axis = if points.len() == 1 { [0.0, 0.0, 1.0] } else { z_of(&frames, points.len()) };
            let along = (0..3).map(|k| (to[k] - last[k]) * axis[k]).sum::<f64>();
            points.push([0, 1, 2].map(|k| last[k] + along * axis[k]));
            points.push(to);
        }
        let drawn: Vec<[f64; 2]> = points.iter().map(|p| seen(*p)).collect();
        body += &stroke(&drawn, "#0072b2", 5.0);
        for frame in &frames[..3] {
            let [x, y] = seen(origin(frame));
            let _ = writeln!(body, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4.5\" fill=\"{INK}\"/>");
        }
        // The pose, the same in each.
        for (k, colour) in ["#d55e00", "#009e73", "#cc79a7"].iter().enumerate() {
            let tip = origin(&t);
            let end = [0, 1, 2].map(|i| tip[i] + 0.2 * t[i][k]);
            body += &stroke(&[seen(tip), seen(end)], colour, 2.5);
        }
        let name = postures_puma560_f64_ik::BRANCHES[usize::from(solution.branch)];
        let words: Vec<&str> = name.split(", ").collect();
        body += &text(x0, y0 - cell[1] + 52.0, 12.0, "middle", &words[..words.len() - 1].join(", "));
        body += &text(x0, y0 - cell[1] + 68.0, 12.0, "middle", words[words.len() - 1]);
    }
    page((across as f64 * cell[0]) as u32, (down as f64 * cell[1]) as u32 + 10, &body)
}

/// The z axis of the frame before the next one: two points represent each frame.
fn z_of(frames: &[[[f64; 4]; 4]; 6], points: usize) -> [f64; 3] {
    let frame = &frames[(points - 1) / 2 - 1];
    [frame[0][2], frame[1][2], frame[2][2]]
}

/// How many postures the UR5 has, the flange pointing ahead and down, over a vertical plane next to its base.
fn solution_count() -> String {
    const STEPS: usize = 120;
    let (left, top, size) = (70.0, 50.0, 480.0);
    let cell = size / STEPS as f64;
    let (low, high) = (-1.1, 1.1);
    let place = |k: usize| low + (k as f64 + 0.5) / STEPS as f64 * (high - low);
    let (c, s) = (0.6, 0.8);
    let mut areas: [String; 9] = Default::default();
    for row in 0..STEPS {
        let count = |column: usize| {
            // The tool's z axis in the plane, tilted; its x axis across.
            let t = [
                [0.0, -c, s, place(column)],
                [1.0, 0.0, 0.0, 0.15],
                [0.0, s, c, 0.1 + place(STEPS - 1 - row)],
                [0.0, 0.0, 0.0, 1.0],
            ];
            let found = postures_ur5_f64_ik::inverse_kinematics(&t);
            assert!(found.verdict != postures_ur5_f64_ik::Verdict::Invalid);
            found.count
        };
        let mut column = 0;
        while column < STEPS {
            let (first, postures) = (column, count(column));
            while column < STEPS && count(column) == postures {
                column += 1;
            }
            let (x, y) = (left + first as f64 * cell, top + row as f64 * cell);
            let _ = write!(areas[postures], "M{x} {y}h{}v{cell}H{x}z", (column - first) as f64 * cell);
        }
    }
    let colours = ["#f2f2f2", "", "#c6dbef", "", "#6baed6", "", "#2171b5", "", "#08306b"];
    let mut body =
        text(left + 0.5 * size, 28.0, 15.0, "middle", "Postures of the UR5 over a plane beside its base, orientation kept");
    for (count, (area, colour)) in areas.iter().zip(colours).enumerate() {
        if area.is_empty() {
            continue;
        }
        // A pose on a border has an odd count; none of these is on one.
        assert!(count % 2 == 0, "{count} postures");
        let _ = writeln!(body, "<path d=\"{area}\" fill=\"{colour}\"/>");
        let y = top + 20.0 + 28.0 * (count / 2) as f64;
        let _ = writeln!(
            body,
            "<rect x=\"{}\" y=\"{}\" width=\"18\" height=\"18\" fill=\"{colour}\" stroke=\"#8c8c8c\"/>",
            left + size + 24.0,
            y
        );
        body += &text(left + size + 50.0, y + 13.5, 12.0, "start", &count.to_string());
    }
    let _ = writeln!(body, "<rect x=\"{left}\" y=\"{top}\" width=\"{size}\" height=\"{size}\" fill=\"none\" stroke=\"{INK}\"/>");
    for k in -2..=2 {
        let value = f64::from(k) * 0.5;
        let x = left + (value - low) / (high - low) * size;
        let y = top + (high - value) / (high - low) * size;
        body += &text(x, top + size + 18.0, 11.0, "middle", &format!("{value:.1}"));
        body += &text(left - 8.0, y + 4.0, 11.0, "end", &format!("{:.1}", value + 0.1));
    }
    body += &text(left + 0.5 * size, top + size + 38.0, 12.0, "middle", "x of the flange, m (y = 0.15 m)");
    body += &format!(
        "<text x=\"22\" y=\"{0}\" font-size=\"12\" text-anchor=\"middle\" transform=\"rotate(-90 22 {0})\">z of the flange, m</text>\n",
        top + 0.5 * size
    );
    page(650, 590, &body)
}

#[track_caller]
fn check(name: &str, drawn: &str) {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/figures").join(name);
    if std::env::var("INSTA_UPDATE").is_ok_and(|update| update == "always") {
        std::fs::write(&file, drawn).expect("the figure can be written");
    }
    let kept = std::fs::read_to_string(&file).unwrap_or_default();
    assert!(kept == drawn, "docs/figures/{name} is another figure than is drawn: INSTA_UPDATE=always writes it");
}

#[test]
fn the_figures_are_those_that_are_drawn() {
    assert_eq!(ur5::DOF, postures_ur5_f64_ik::DOF);
    check("inverse_kinematics_postures.svg", &eight_postures());
    check("inverse_kinematics_count.svg", &solution_count());
}
