use super::*;

/// Renders a diagnostic at the first `~` range of `marked` (two lines: text, then a row of `~` under it).
#[track_caller]
fn check(text: &str, part: &str, place: &str, line: &str, underline: &str) {
    let source = Source::new("robot.yaml", text);
    let start = source.text().find(part).expect("the part stands in the text");
    let mut diagnostics = Diagnostics::new();
    diagnostics.push(Diagnostic::new(Code::UnknownKey, Span::new(start, start + part.len()), "message", "label", "help"));
    let rendered = diagnostics.render(&source, Colour::Never);
    assert!(rendered.contains(&format!("--> robot.yaml:{place}\n")), "{rendered}");
    assert_eq!(source.place(start).to_string(), place);
    assert!(rendered.contains(line), "{rendered}");
    assert!(rendered.contains(&format!("| {underline} label\n")), "{rendered}");
    assert!(rendered.starts_with("error[unknown-key]: message\n"), "{rendered}");
    assert!(rendered.contains("= help: help\n"), "{rendered}");
}

#[test]
fn places_agree_with_the_rendered_line() {
    check("a: 1\nbc: 2\n", "bc", "2:1", "2 | bc: 2", "^^");
    check("a: 1\r\nbc: xyz\r\n", "xyz", "2:5", "2 | bc: xyz", "    ^^^");
    check("a: 1\rbc: xyz\rd: 2\r", "xyz", "2:5", "2 | bc: xyz", "    ^^^");
    check("\u{feff}a: 1", "1", "1:4", "1 | a: 1", "   ^");
    check("ä: \u{1f916} x", "x", "1:6", "1 | ä: \u{1f916} x", "      ^");
    check("a:\tx", "x", "1:4", "1 | a:    x", "      ^");
    check(&format!("{}b: 1", "#\n".repeat(20_000)), "b", "20001:1", "20001 | b: 1", "^");
}

#[test]
fn diagnostics_stand_in_the_order_of_the_text_and_only_once() {
    let at = |start, code| Diagnostic::new(code, Span::new(start, start + 1), "m", "l", "h");
    let mut diagnostics = Diagnostics::new();
    diagnostics.push(at(5, Code::UnusedParameter));
    diagnostics.push(at(2, Code::UnknownKey));
    diagnostics.push(at(2, Code::UnknownKey));
    diagnostics.push(at(2, Code::RoundedAngle));
    diagnostics.sort();
    let codes: Vec<_> = diagnostics.iter().map(|d| d.code).collect();
    assert_eq!(codes, [Code::UnknownKey, Code::RoundedAngle, Code::UnusedParameter]);
    assert_eq!((diagnostics.errors(), diagnostics.warnings()), (1, 2));
}

#[test]
fn faults_of_one_long_line_are_counted_where_they_would_take_long_to_show() {
    let line = "x".repeat(RENDERED_BYTES / 3 + 1);
    let source = Source::new("robot.yaml", line);
    let mut diagnostics = Diagnostics::new();
    for start in 0..10 {
        diagnostics.push(Diagnostic::new(Code::UnknownKey, Span::new(start, start + 1), "message", "label", "help"));
    }
    let rendered = diagnostics.render(&source, Colour::Never);
    assert_eq!(rendered.matches("error[unknown-key]").count(), 3);
    assert!(rendered.ends_with("robot.yaml: 7 more not shown\n\n"), "{}", rendered.len());
    // The renderer shows the part of the line around the label alone.
    assert!(rendered.len() < 2000, "{}", rendered.len());
}

/// An error is shown after any number of warnings: it is the reason why there is no arm.
#[test]
fn the_first_error_is_shown_behind_all_warnings() {
    let shown = |text: String, warnings: usize| {
        let source = Source::new("robot.yaml", text);
        let mut diagnostics = Diagnostics::new();
        for start in 0..warnings + 2 {
            let code = if start < warnings { Code::UnusedParameter } else { Code::UnknownKey };
            diagnostics.push(Diagnostic::new(code, Span::new(start, start + 1), "message", "label", "help"));
        }
        let rendered = diagnostics.render(&source, Colour::Never);
        assert!(rendered.ends_with(" more not shown\n\n"));
        (rendered.matches("warning[unused-parameter]").count(), rendered.matches("error[unknown-key]").count())
    };
    assert_eq!(shown("x".repeat(RENDERED_BYTES / 3 + 1), 10), (3, 1));
    assert_eq!(shown("x\n".repeat(RENDERED), RENDERED + 10), (RENDERED, 1));
}

#[test]
fn an_empty_text_has_a_place_too() {
    let source = Source::new("robot.yaml", "");
    let mut diagnostics = Diagnostics::new();
    diagnostics.push(Diagnostic::new(Code::EmptyFile, Span::new(0, 0), "the file is empty", "", "write one"));
    assert!(diagnostics.render(&source, Colour::Never).contains("robot.yaml:1:1"));
    assert!(diagnostics.render(&source, Colour::Always).contains("\u{1b}["));
}

#[test]
fn names_of_codes_are_kebab_case_and_differ() {
    let names: BTreeSet<&str> = Code::ALL.iter().map(|c| c.name()).collect();
    assert_eq!(names.len(), Code::ALL.len());
    assert!(names.iter().all(|n| n.chars().all(|c| c.is_ascii_lowercase() || c == '-')));
}
