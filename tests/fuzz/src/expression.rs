//! Any text as expressions, one a line, each under `parameters` and free to name those above it.

use armgen_codegen::{
    document::{parse_expression, yaml},
    source::{Source, Span},
    validate,
};

/// A line as a plain scalar of YAML.
fn plain(line: &str) -> String {
    line.chars().filter(|c| !c.is_control() && !matches!(c, ':' | '#')).collect()
}

/// The target.
///
/// # Panics
/// Where the reader is wrong.
pub fn run(data: &[u8]) {
    let text = String::from_utf8_lossy(data);
    let lines: Vec<String> = text.lines().take(8).map(plain).filter(|line| !line.trim().is_empty()).collect();
    for line in &lines {
        let scalar = yaml::Scalar { text: line.clone(), plain: true, verbatim: Some(0) };
        match parse_expression(&scalar, Span::new(0, line.len())) {
            Ok(expression) => {
                let _ = (expression.to_f64(), expression.is_decimal(), expression.as_name());
                for (name, span) in expression.named() {
                    // A name is marked with its parentheses, and with the signs inside them that change nothing.
                    assert_eq!(line[span.range()].trim_matches(['(', ')', '+', ' ']), name);
                }
            }
            Err(diagnostic) => assert!(!diagnostic.help.is_empty()),
        }
    }
    let mut robot = String::from("name: arm\nconvention: standard\ngravity: [0, 0, -9.81]\n");
    if !lines.is_empty() {
        robot += "parameters:\n";
    }
    for (i, line) in lines.iter().enumerate() {
        robot += &format!("  p{i}: {line}\n");
    }
    let last = lines.len().saturating_sub(1);
    let (theta, a) =
        if lines.is_empty() { (String::from("0"), String::from("1")) } else { (format!("p{last}"), format!("p{last}")) };
    robot += &format!(
        "joints:\n  - {{name: j1, type: revolute, a: {a}, alpha: {theta}, d: p0, theta: 0, link: {{mass: 1}}}}\n  \
         - {{name: j2, type: revolute, a: 1, alpha: 0, d: 0, theta: {theta}, link: {{mass: 1}}}}\n"
    );
    let source = Source::new("robot.yaml", robot);
    let (valid, diagnostics) = validate::read(&source);
    assert_eq!(valid.is_some(), !diagnostics.has_errors());
    super::check_diagnostics(&source, &diagnostics);
}
