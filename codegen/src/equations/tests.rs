use super::*;
use crate::diagnostic::Colour;

/// A one-joint arm; `edits` replace parts of it, and an edit without a match is appended.
fn arm(edits: &[(&str, &str)]) -> String {
    let mut text = "name: arm\nconvention: standard\ngravity: [0, 0, -9.81]\nparameters: {}\njoints:\n  - name: shoulder\n    \
                    type: revolute\n    a: 0.5\n    alpha: pi/2\n    d: 0.25\n    theta: 0\n    link: {mass: 2}\n"
        .to_owned();
    for (old, new) in edits {
        match old.is_empty() {
            true => text += new,
            false => {
                assert!(text.contains(old), "{old} in {text}");
                text = text.replacen(old, new, 1);
            }
        }
    }
    text
}

#[track_caller]
fn valid(text: &str) -> (Manipulator, Places) {
    let source = Source::new("robot.yaml", text);
    let (read, diagnostics) = read(&source);
    read.unwrap_or_else(|| panic!("{}", diagnostics.render(&source, Colour::Never)))
}

/// Expects these codes, in the order of the text, and an arm just where none is an error.
#[track_caller]
fn check(text: &str, codes: &[Code]) {
    let source = Source::new("robot.yaml", text);
    let (read, diagnostics) = read(&source);
    // The numbers of these texts are not realistic for arms.
    let of_values = |code: &Code| *code >= Code::ImplausibleReach;
    let found: Vec<_> =
        diagnostics.iter().map(|d| d.code).filter(|c| !Code::ALL.iter().any(|v| *c == *v && of_values(v))).collect();
    assert_eq!(found, codes, "{}", diagnostics.render(&source, Colour::Never));
    assert_eq!(read.is_some(), !diagnostics.has_errors());
}

#[test]
fn an_arm_has_a_field_with_all_its_roots_or_is_too_complex() {
    let roots = |primes: &[i64]| primes.iter().map(|p| format!("sqrt({p})/100")).collect::<Vec<_>>().join("+");
    let two = format!("{{mass: 2, com: [{}, {}, 0]}}", roots(&[5, 7, 11]), roots(&[13, 17]));
    check(&arm(&[("{mass: 2}", &two)]), &[]);
    let all = [roots(&[5, 7, 11, 13, 17, 19, 23]), roots(&[29, 31, 37, 41, 43, 47, 53]), roots(&[59, 61, 67, 71, 73, 79])];
    check(&arm(&[("{mass: 2}", &format!("{{mass: 2, com: [{}]}}", all.join(", ")))]), &[Code::TooComplex]);
}

/// Base parameters that are too long are refused where the file asks for them.
#[test]
fn long_combinations_are_said_at_the_key() {
    let text = arm(&[("", "regressor: base\n")]);
    let (_, places) = valid(&text);
    let found = long_combinations(&places);
    assert_eq!(found.code, Code::TooComplex);
    assert!(text[found.span().start..].starts_with("regressor: base"), "{found:?}");
}

/// A root in any quantity that the equations hold squares to its number in the field.
#[test]
fn roots_of_motors_and_friction_are_in_the_field() {
    for edit in [
        "    motor: {inertia: sqrt(7)}\n",
        "    motor: {viscous: sqrt(7)}\n",
        "    motor: {mass: sqrt(7)}\n",
        "    friction: {viscous: sqrt(7)}\n",
        "    friction: {coulomb: sqrt(7)}\n",
    ] {
        let (arm, _) = valid(&arm(&[("", edit)]));
        let mut field = crate::derive::constants::field_of(&arm);
        let root = field.number(&Number::from(7).sqrt().expect("positive"));
        assert_eq!(field.mul(root, root), field.from_u64(7), "{edit}");
    }
}

/// The sums of a mass and of its centre of mass are not multiplied out: 3 times 60³/2 products here.
#[test]
fn long_sums_stay_sums_in_the_equations() {
    use crate::derive::arm::Arm;
    use crate::derive::parameters::View;
    use crate::ring::Pool;
    let sum = |letter: &str| (0..60).map(|i| format!("{letter}{i}")).collect::<Vec<_>>().join("+");
    let mut parameters = String::from("parameters:\n");
    ["a", "b"].iter().for_each(|letter| (0..60).for_each(|i| parameters += &format!("  {letter}{i}: 1\n")));
    let body = format!("{{mass: {}, com: [{}, 0.1, 0], inertia: {{xx: 1, yy: 1, zz: 1}}}}", sum("a"), sum("b"));
    let (arm, _) = valid(&arm(&[("parameters: {}\n", &parameters), ("{mass: 2}", &body)]));
    let mut pool = Pool::new(crate::derive::constants::field_of(&arm));
    Arm::new(&mut pool, &arm, View::Symbolic);
    assert!(pool.len() < 1000, "{} nodes", pool.len());
}

#[test]
fn each_name_that_is_not_linear_is_reported_once_and_not_all_of_very_many() {
    let names = |letter: &str, n: usize| (0..n).map(|i| format!("{letter}{i}")).collect::<Vec<_>>();
    let with = |n: usize| {
        let (a, b) = (names("a", n), names("b", n));
        let all = [a.clone(), b.clone()].concat();
        let parameters: String = all.iter().map(|name| format!("  {name}: 1\n")).collect();
        let link = format!("{{mass: {}, com: [{}, 0, 0], inertia: {{xx: 1, yy: 1, zz: 1}}}}", a.join("+"), b.join("+"));
        let regressor = format!("regressor: [{}]\n", all.join(", "));
        let edits = [("parameters: {}\n", format!("parameters:\n{parameters}")), ("{mass: 2}", link), ("", regressor)];
        arm(&edits.each_ref().map(|(old, new)| (*old, new.as_str())))
    };
    // The a's with the first b, the b's with themselves.
    check(&with(4), &[Code::NonlinearParameter; 8]);
    check(&with(60), &[Code::NonlinearParameter; 50]);
}
