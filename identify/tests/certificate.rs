//! Certificates: what is proved of written numbers, and that nothing of them can change.

use armgen_codegen::source::Source;
use armgen_identify::certificate::{check, write_certified, Proved, LARGEST_GAP};
use armgen_identify::consistent::consistent;
use armgen_identify::finding::Findings;
use armgen_identify::identify::{identify, Input};
use armgen_identify::log::read;
use armgen_identify::options::Options;

use crate::arms::{arm, csv, format, motion, Random, ELBOW};

/// An identified elbow and its certificate; logs with noise of a size, N m.
fn certified(noise: f64) -> (Source, String) {
    let guess = ELBOW.replace("mass: 7", "mass: 5.5").replace("viscous: 6", "viscous: 1");
    let (source, text, proved) = certified_from(&guess, noise);
    assert!(proved.gap.as_ref().is_ok_and(|gap| *gap <= LARGEST_GAP), "{proved:?}");
    (source, text)
}

fn certified_from(guess: &str, noise: f64) -> (Source, String, Proved) {
    let (truth, arm) = (arm(ELBOW), arm(guess));
    let mut motion = motion(ELBOW, 5, 20.0, 100.0);
    let mut random = Random(8);
    motion.tau.iter_mut().for_each(|tau| *tau += noise * random.normal());
    let (log, findings) = read("log.csv", csv(&truth, &motion, 6).as_bytes(), &format(&arm));
    assert!(!findings.has_errors());
    let mut findings = Findings::default();
    let found = identify(&arm, &[Input { log, ..Input::default() }], &Options::default(), &mut findings).expect("a good log");
    let of = consistent(&arm, &found.reduced);
    let guess = Source::new("guess", guess);
    let (written, text, proved) = write_certified(&guess, false, &arm, &found, &of).unwrap_or_else(|reason| panic!("{reason}"));
    let source = Source::new("identified.yaml", written.text);
    println!("noise {noise}: {proved:?}, {} bytes", text.len());
    assert_eq!(proved.bodies, 3);
    assert_eq!(check(&source, &text).as_ref(), Ok(&proved));
    (source, text, proved)
}

/// A tensor in axes with roots: bodies are proved possible, and the reason why no more is proved is given and verified.
#[test]
fn bodies_with_roots_are_proved_possible() {
    let guess = ELBOW.replace("inertia: {xx: 0.02, ", "inertia: {rpy: [0, pi/4, 0], xx: 0.02, ");
    assert_ne!(guess, ELBOW);
    let (source, text, proved) = certified_from(&guess, 0.2);
    let reason = proved.gap.expect_err("roots are no fractions");
    assert!(reason.contains("shoulder") && reason.contains("not rational"), "{reason}");
    let all: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let mut changed = all.clone();
    changed["bodies"][1]["pivots"][0] = "3".into();
    assert!(check(&source, &with_digest(&changed.to_string())).is_err());
    // Nor can a certificate claim more than there is.
    assert!(all["optimality"].get("gap").is_none(), "{}", all["optimality"]);
}

/// The digest after a change: a digest protects from slips, the proof from all else.
fn with_digest(text: &str) -> String {
    let mut all: serde_json::Value = serde_json::from_str(text).expect("JSON");
    all.as_object_mut().expect("an object").remove("sha256");
    let digest = <sha2::Sha256 as sha2::Digest>::digest(all.to_string().as_bytes());
    all["sha256"] = digest.iter().map(|byte| format!("{byte:02x}")).collect::<String>().into();
    all.to_string()
}

#[test]
fn identified_numbers_are_proved_possible_and_optimal() {
    let (source, text) = certified(0.5);
    certified(0.0);
    // One digit, anywhere.
    let mut random = Random(3);
    let digits: Vec<usize> = (0..text.len()).filter(|&at| text.as_bytes()[at].is_ascii_digit()).collect();
    for _ in 0..20 {
        let at = digits[(random.unit() * digits.len() as f64) as usize];
        let digit = (text.as_bytes()[at] - b'0' + 1) % 10;
        let changed = format!("{}{digit}{}", &text[..at], &text[at + 1..]);
        assert!(check(&source, &changed).is_err(), "{at}");
    }
    let other = Source::new("identified.yaml", source.text().replacen("identified: ", "identified:  ", 1));
    assert!(check(&other, &text).expect_err("it is of another text").contains("another description"));
    // With the digest of the changed text the proof itself refuses.
    let all: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!(check(&source, &with_digest(&text)), check(&source, &text));
    for (path, what) in
        [("/optimality/gap", "gap"), ("/optimality/c", "data"), ("/optimality/point/0", "point"), ("/bodies/1/pivots/2", "pivot")]
    {
        let mut changed = all.clone();
        let value = changed.pointer_mut(path).expect("it is there");
        let number = value.as_str().expect("text");
        let at = number.find(|c: char| ('1'..='8').contains(&c)).expect("a digit");
        let digit = number.as_bytes()[at] - b'0' + 1;
        *value = format!("{}{digit}{}", &number[..at], &number[at + 1..]).into();
        let refused = check(&source, &with_digest(&changed.to_string()));
        println!("{what}: {refused:?}");
        assert!(refused.is_err(), "{what}");
    }
}
