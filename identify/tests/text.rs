//! Identified numbers in the texts of descriptions, and the bodies that they are.

use armgen_codegen::derive::parameters::nominal;
use armgen_codegen::exact::Polynomial;
use armgen_codegen::source::Source;
use armgen_codegen::validate;
use armgen_identify::body;
use armgen_identify::consistent::{consistent, Consistent};
use armgen_identify::finding::Findings;
use armgen_identify::identify::{identify, FrictionValue, Identified, Input, Interval, Reduced};
use armgen_identify::log::read;
use armgen_identify::options::Options;
use armgen_identify::prepare::Friction;
use armgen_identify::written::write;
use nalgebra::{Matrix3, Vector3};

use crate::arms::{arm, csv, format, motion, Random, ELBOW};

/// A value of a description. A number that identification may change stands between the marks 1 and 2.
enum Y {
    Text(String),
    Number(String),
    List(Vec<Y>),
    Map(Vec<(&'static str, Y)>),
    Anchored(Box<Y>),
    Alias,
}

struct Style {
    random: Random,
    newline: &'static str,
    comments: usize,
    names: Vec<(String, String)>,
}

impl Style {
    fn chance(&mut self, share: f64) -> bool {
        self.random.unit() < share
    }

    fn comment(&mut self) -> String {
        self.comments += 1;
        let odd = ["plain", "'quote", "\"two", "{ [ , : - 5", "a: 1", "# twice"];
        format!("#{} {}", self.comments, odd[self.comments % odd.len()])
    }

    /// A number as a decimal, an expression, or a name.
    fn number(&mut self, x: f64) -> Y {
        let text = match (self.random.unit() * 8.0) as usize {
            0 => format!("{}/2", 2.0 * x),
            1 => format!("{x:e}"),
            2 => format!("sqrt(4)*{x}/2"),
            3 => {
                let name = format!("name_{}", self.names.len());
                self.names.push((name.clone(), format!("{x}")));
                return Y::Text(name);
            }
            _ => format!("{x}"),
        };
        Y::Number(text)
    }

    fn scalar(&mut self, text: &str, mark: bool) -> String {
        let text = if mark { format!("\u{1}{text}\u{2}") } else { text.to_owned() };
        match (self.random.unit() * 6.0) as usize {
            0 => format!("'{text}'"),
            1 => format!("\"{text}\""),
            _ => text,
        }
    }

    fn flow(&mut self, y: &Y, indent: usize) -> String {
        let gap = |style: &mut Style| {
            if style.chance(0.1) {
                format!(" {}{}{}", style.comment(), style.newline, " ".repeat(indent + 4))
            } else {
                [" ", "  "][usize::from(style.chance(0.2))].to_owned()
            }
        };
        match y {
            Y::Text(text) => self.scalar(text, false),
            Y::Number(text) => self.scalar(text, true),
            Y::List(items) => {
                let mut text = String::from("[");
                for (k, item) in items.iter().enumerate() {
                    text += &if k > 0 { format!(",{}", gap(self)) } else { String::new() };
                    text += &self.flow(item, indent);
                }
                text + "]"
            }
            Y::Map(entries) => {
                let mut text = String::from("{");
                for (k, (key, value)) in entries.iter().enumerate() {
                    text += &if k > 0 { format!(",{}", gap(self)) } else { String::new() };
                    text += &format!("{key}: {}", self.flow(value, indent));
                }
                text + "}"
            }
            Y::Anchored(y) => format!("&shared {}", self.flow(y, indent)),
            Y::Alias => "*shared".to_owned(),
        }
    }

    fn block(&mut self, entries: &[(&'static str, Y)], indent: usize, first: bool) -> String {
        let mut text = String::new();
        for (k, (key, value)) in entries.iter().enumerate() {
            if !(first && k == 0) {
                if self.chance(0.1) {
                    text += &format!("{}{}", self.comment(), self.newline);
                }
                if self.chance(0.1) {
                    text += self.newline;
                }
                text += &" ".repeat(indent);
            }
            match value {
                Y::Map(inner) if !inner.is_empty() && self.chance(0.5) => {
                    let comment = if self.chance(0.3) { format!("  {}", self.comment()) } else { String::new() };
                    let inner = self.block(inner, indent + 2, false);
                    text += &format!("{key}:{comment}{}{inner}", self.newline);
                }
                Y::List(items) if matches!(items.first(), Some(Y::Map(_))) => {
                    text += &format!("{key}:{}", self.newline);
                    for item in items {
                        let Y::Map(inner) = item else { continue };
                        let inner = self.block(inner, indent + 4, true);
                        text += &format!("{}- {inner}", " ".repeat(indent + 2));
                    }
                }
                value => {
                    let value = self.flow(value, indent);
                    let end = match (self.random.unit() * 6.0) as usize {
                        0 => format!("   {}", self.comment()),
                        1 => "\t".to_owned(),
                        2 => format!(" \t{}", self.comment()),
                        _ => String::new(),
                    };
                    text += &format!("{key}: {value}{end}{}", self.newline);
                }
            }
        }
        text
    }
}

/// The elbow in an odd style, and whether nothing is missing or shared in it.
fn odd(seed: u64) -> (String, bool) {
    let mut style = Style { random: Random(seed), newline: "\n", comments: 0, names: Vec::new() };
    style.random.unit();
    style.newline = if style.chance(0.3) { "\r\n" } else { "\n" };
    let whole = style.chance(0.5);
    let shares = !whole && style.chance(0.5);
    let text = |text: &str| Y::Text(text.to_owned());
    let mut joints = Vec::new();
    for (i, [a, alpha, d]) in [["0", "pi/2", "0.3"], ["0.4", "0", "0"], ["0.35", "0", "0"]].into_iter().enumerate() {
        let mut link = vec![("mass", style.number(5.0 - i as f64))];
        if whole || style.chance(0.7) {
            link.push(("com", Y::List([-0.1, 0.02, 0.03].map(|x| style.number(x)).into())));
        }
        if whole || style.chance(0.7) {
            let mut elements = Vec::new();
            for (name, x) in [("xx", 0.02), ("xy", 0.001), ("yy", 0.05), ("xz", 0.002), ("yz", -0.001), ("zz", 0.045)] {
                if whole || !name.starts_with(['x', 'y']) || name.ends_with(&name[..1]) || style.chance(0.7) {
                    elements.push((name, style.number(x)));
                }
            }
            link.push(("inertia", Y::Map(elements)));
        }
        let mut motor = vec![("ratio", text("100"))];
        if whole || style.chance(0.6) {
            motor.push(("inertia", style.number(4e-5)));
        }
        let mut friction = Vec::new();
        for (name, x) in [("viscous", 4.0), ("coulomb", 3.0), ("offset", 0.4), ("load", 0.02)] {
            if whole || style.chance(0.6) {
                // Shared values have no names, which would be used twice.
                friction.push((name, if shares { Y::Number(format!("{x}")) } else { style.number(x) }));
            }
        }
        let friction = match (shares, i) {
            (true, 0) => Y::Anchored(Box::new(Y::Map(friction))),
            (true, 1) => Y::Alias,
            _ => Y::Map(friction),
        };
        let mut joint = vec![
            ("name", text(["base", "shoulder", "elbow"][i])),
            ("type", text("revolute")),
            ("a", text(a)),
            ("alpha", text(alpha)),
            ("d", text(d)),
            ("theta", text("0")),
            ("link", Y::Map(link)),
            ("motor", Y::Map(motor)),
        ];
        if whole || shares || style.chance(0.7) {
            joint.push(("friction", friction));
        }
        joints.push(Y::Map(joint));
    }
    let mut robot = vec![
        ("name", text("elbow")),
        ("convention", text("standard")),
        ("gravity", Y::List(["0", "0", "-9.81"].map(text).into())),
    ];
    robot.push(("joints", Y::List(joints)));
    robot.push(("tool", Y::Map(vec![("xyz", Y::List(["0", "0", "0.05"].map(text).into()))])));
    let mut yaml = style.block(&robot, 0, false);
    if !style.names.is_empty() {
        yaml += &format!("parameters:   #last{}", style.newline);
        for (name, value) in &style.names {
            yaml += &format!("  {name}: \u{1}{value}\u{2}{}", style.newline);
        }
    }
    yaml += "regressor: base";
    (yaml, whole)
}

/// The text without our comments.
fn without_comments(text: &str) -> String {
    let mut left = String::new();
    for line in text.split_inclusive(['\n', '\r']).filter(|line| !line.starts_with("# identified joint ")) {
        match line.find(" # identified: ") {
            Some(at) => left += &[&line[..at], line[at..].trim_start_matches(|c| c != '\n' && c != '\r')].concat(),
            None => left += line,
        }
    }
    left
}

fn check_style(seed: u64) {
    let (marked, whole) = odd(seed);
    let yaml = marked.replace(['\u{1}', '\u{2}'], "");
    let arm = arm(&yaml);
    let mut random = Random(seed + 1000);
    let bodies = (0..3)
        .map(|_| {
            let spread = Matrix3::from_fn(|_, _| random.within(-0.1, 0.1)) + Matrix3::identity() * 0.05;
            let tensor = 3.0 * body::tensor(&(spread * spread.transpose()));
            body::ten(random.within(1.0, 8.0), Vector3::from_fn(|_, _| random.within(-0.2, 0.2)), &tensor)
        })
        .collect();
    let interval = |value: f64| Interval { value, sigma: 0.01, low: value - 0.03, high: value + 0.03, excited: true };
    let terms = [Friction::Viscous, Friction::Coulomb, Friction::Offset, Friction::Cubic, Friction::Stribeck];
    let friction: Vec<FrictionValue> = (0..3)
        .flat_map(|joint| terms.map(|term| (joint, term)))
        .map(|(joint, term)| FrictionValue { session: 0, joint, term, value: interval(random.within(0.5, 2.0)) })
        .collect();
    let found = Identified {
        base: arm.base.iter().map(|_| interval(0.0)).collect(),
        sessions: vec![String::new()],
        velocities: vec![0.123; 3],
        delays: vec![interval(1e-3); 3],
        spreads: vec![0.2; 3],
        reduced: Reduced { friction: friction.iter().map(|of| (of.joint, of.term)).collect(), ..Reduced::default() },
        friction: friction.clone(),
        ..Identified::default()
    };
    let of = Consistent {
        bodies,
        rotors: (0..3).map(|_| random.within(1e-5, 1e-4)).collect(),
        friction: friction.iter().map(|of| of.value.value).collect(),
        ..Consistent::default()
    };
    let source = Source::new("odd", yaml.as_str());
    let written = write(&source, &arm, &found, &of).unwrap_or_else(|reason| panic!("seed {seed}: {reason}\n{yaml}"));
    let text = &written.text;
    // Comments of the user are all there, in their order, and so are line ends.
    let mut at = 0;
    for k in 1..=marked.matches('#').count() {
        let Some(comment) = yaml.find(&format!("#{k} ")).map(|start| yaml[start..].split(['\r', '\n']).next().unwrap_or(""))
        else {
            break;
        };
        if let Some(found) = text.find(comment) {
            at = at.max(found);
        } else {
            panic!("seed {seed}: `{comment}` is lost\n{text}");
        }
    }
    assert_eq!(yaml.contains("\r\n"), text.contains("\r\n"), "seed {seed}");
    assert_eq!(
        text.matches('\n').count() == text.matches("\r\n").count(),
        yaml.contains("\r\n"),
        "seed {seed}: mixed line ends\n{text}"
    );
    if whole {
        // Without missing keys nothing but numbers differs; the terms that the file lacks are in the mappings of friction.
        let mut rest = without_comments(text);
        let added = |rest: &mut String, from: &str| {
            while let Some(start) = rest.find(from) {
                let tail = &rest[start + 1..];
                let stop = tail.find("velocity").and_then(|v| tail[v..].find('}').map(|end| start + 1 + v + end + 1));
                rest.replace_range(start..stop.unwrap_or(rest.len()), "");
            }
        };
        added(&mut rest, ", cubic: ");
        while let Some(start) = rest.find("cubic: ") {
            let line = rest[..start].rfind('\n').unwrap_or(0) + 1;
            let next = rest[start..].find("stribeck").map_or(start, |at| start + at);
            let end = rest[next..].find('\n').map_or(rest.len(), |at| next + at + 1);
            rest.replace_range(line..end, "");
        }
        let mut fixed = Vec::new();
        for (k, part) in marked.split('\u{1}').enumerate() {
            fixed.push(if k == 0 { part } else { part.split_once('\u{2}').map_or(part, |(_, rest)| rest) });
        }
        let mut left = rest.as_str();
        for (k, part) in fixed.iter().enumerate() {
            let at = if k == 0 { left.starts_with(part).then_some(0) } else { left.find(part) };
            let at = at.unwrap_or_else(|| panic!("seed {seed}: `{part}` is not there in\n{left}\n of\n{text}"));
            let number = &left[..at];
            assert!(number.chars().all(|c| c.is_ascii_digit() || "-.e/*+sqrt()".contains(c)), "seed {seed}: `{number}`");
            left = &left[at + part.len()..];
        }
        assert!(left.trim().is_empty(), "seed {seed}: {left}");
    }
    // Reading gives the numbers.
    let (read, _) = validate::read(&Source::new("again", text.as_str()));
    let (manipulator, _) = read.expect("it was read before");
    for (i, joint) in manipulator.joints.iter().enumerate() {
        let number = |value: &Polynomial| nominal(&manipulator, value).to_f64();
        let own = &joint.link[0].given;
        let near = |a: f64, b: f64| (a - b).abs() < 1e-3 * b.abs().max(0.05);
        assert!(near(number(&own.mass), of.bodies[i][0]), "seed {seed}");
        for k in 0..3 {
            assert!(near(number(&own.com[k]), of.bodies[i][1 + k] / of.bodies[i][0]), "seed {seed}");
        }
        for (k, term) in [&joint.viscous, &joint.coulomb, &joint.offset, &joint.cubic].into_iter().enumerate() {
            let value = term.as_ref().map_or(0.0, number);
            assert!((value - of.friction[5 * i + k]).abs() <= 1e-4, "seed {seed}: {value}");
        }
        assert!(joint.load.as_ref().is_none_or(|load| load.to_f64() == 0.0), "seed {seed}");
    }
    assert!(written.pivots.iter().flatten().all(|pivot| *pivot > 0.0));
}

#[test]
fn odd_styles_keep_all_but_numbers() {
    (1..=6).for_each(check_style);
}

#[test]
#[ignore = "wide"]
fn fifty_odd_styles_keep_all_but_numbers() {
    (1..=50).for_each(check_style);
}

/// A log of the true elbow, and a description with guesses: the written file has bodies that exist and the torques of the true arm.
#[test]
fn a_written_file_has_possible_bodies_and_the_torques_of_the_arm() {
    let guess = ELBOW.replace("mass: 7", "mass: 5.5").replace("mass: 3,", "mass: 4,").replace("viscous: 6", "viscous: 1");
    let (truth, arm) = (arm(ELBOW), arm(&guess));
    let text = csv(&truth, &motion(ELBOW, 5, 20.0, 100.0), 6);
    let (log, findings) = read("log.csv", text.as_bytes(), &format(&arm));
    assert!(!findings.has_errors());
    let mut findings = Findings::default();
    let found = identify(&arm, &[Input { log, ..Input::default() }], &Options::default(), &mut findings).expect("a good log");
    let of = consistent(&arm, &found.reduced);
    println!("{} steps, mu {:e}, {:e} over {:e}", of.steps, of.mu, of.objective, of.unconstrained);
    assert!(of.objective < 1.01 * of.unconstrained, "{} {}", of.objective, of.unconstrained);
    let written = write(&Source::new("guess", guess.as_str()), &arm, &found, &of).unwrap_or_else(|reason| panic!("{reason}"));
    let (manipulator, _) = validate::read(&Source::new("again", written.text.as_str())).0.expect("it is valid");
    let again = armgen_identify::arm::Arm::new(&manipulator, false).expect("it has mass");
    let other = motion(ELBOW, 6, 5.0, 50.0);
    let pi = (&again.combination * again.nominal()).as_slice().to_vec();
    let exact = (&truth.combination * truth.nominal()).as_slice().to_vec();
    let (tau, right) =
        (again.torque(&other.q, &other.dq, &other.ddq, &pi), truth.torque(&other.q, &other.dq, &other.ddq, &exact));
    let error: f64 = tau.iter().zip(&right).map(|(a, b)| (a - b).powi(2)).sum();
    let size: f64 = right.iter().map(|tau| tau * tau).sum();
    assert!((error / size).sqrt() < 4e-3, "{}", (error / size).sqrt());
    // Masses that no motion shows stay near the guess: without D they run away.
    for (again, guess) in again.links.iter().zip(&arm.links) {
        assert!((0.5..2.0).contains(&(again.own[0] / guess.own[0])), "{} {}", again.own[0], guess.own[0]);
    }
}

/// A body without extent, or with a moment that is too large, has no positive pivots and is refused.
#[test]
fn an_impossible_body_is_not_written() {
    let arm = arm(ELBOW);
    let found = Identified {
        base: arm.base.iter().map(|_| Interval { sigma: 1e-3, excited: true, ..Interval::default() }).collect(),
        sessions: vec![String::new()],
        velocities: vec![0.1; 3],
        delays: vec![Interval::default(); 3],
        spreads: vec![0.2; 3],
        ..Identified::default()
    };
    let mut of = Consistent {
        bodies: arm.links.iter().map(|link| link.own).collect(),
        rotors: vec![4e-5, 5e-5, 2e-5],
        ..Consistent::default()
    };
    let source = Source::new("elbow", ELBOW);
    assert!(write(&source, &arm, &found, &of).is_ok());
    // Ixx + Iyy < Izz by one part in a million.
    of.bodies[1] = body::ten(7.0, Vector3::zeros(), &Matrix3::from_diagonal(&Vector3::new(0.02, 0.1, 0.12 * (1.0 + 1e-6))));
    let refused = write(&source, &arm, &found, &of).expect_err("no body has this inertia");
    assert!(refused.contains("`shoulder`"), "{refused}");
    // A rod of little width across all axes: rounded to few digits it has a negative principal moment, which `check` refuses as impossible.
    let along = Vector3::new(1.0, 2.0, 3.0).normalize();
    let mut rod = |width: f64| {
        let tensor = Matrix3::identity() * (1.0 + 2.0 * width) - along * along.transpose();
        of.bodies[1] = body::ten(7.0, Vector3::new(-0.18, 0.01, 0.03), &(0.1 * tensor));
        write(&source, &arm, &found, &of)
    };
    let few = rod(1e-2).expect("few digits").digits;
    let more = rod(1e-6).expect("more digits").digits;
    assert!(few < more, "{few} {more}");
    let refused = rod(1e-15).expect_err("twelve digits are too few");
    assert!(refused.contains("rounded to 12 digits, no bod"), "{refused}");
}
