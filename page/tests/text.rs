//! Pages as texts: the same input gives the same bytes, a faulty description gives no page, and text of a file never becomes markup.

use armgen_codegen::source::Source;
use armgen_codegen::{schedule, validate, Model, Options, Trig};

const ARM: &str = "name: arm
convention: standard
gravity: [0, 0, -9.81]
joints:
  - {name: only, type: revolute, a: 0.5, alpha: 0, d: 0, theta: 0, link: {mass: 1, com: [0, 0, 0], inertia: {xx: 1, yy: 1, zz: 1}}}
";

fn page(name: &str, text: &str) -> String {
    armgen_page::page(&Source::new(name, text), &[]).expect("no logs").0.expect("a valid description")
}

#[test]
fn the_same_text_gives_the_same_bytes_wherever_it_lies() {
    assert_eq!(page("a/arm.yaml", ARM), page("/b/c/arm.yaml", ARM));
}

/// A rule that makes a table cell a block takes it out of its column, so every such rule must name the element it means.
#[test]
fn no_rule_of_the_style_takes_a_cell_out_of_its_column() {
    let page = page("arm.yaml", ARM);
    let style = page.split("<style>").nth(1).and_then(|rest| rest.split("</style>").next()).expect("a style");
    let mut blocks = 0;
    for rule in style
        .split('}')
        .filter(|rule| rule.replace(' ', "").contains("display:block") || rule.replace(' ', "").contains("display:grid"))
    {
        let selectors = rule.rsplit_once('{').map_or("", |(selectors, _)| selectors);
        for selector in selectors.split(',').map(str::trim).filter(|selector| selector.contains(".written")) {
            blocks += 1;
            assert!(selector.contains("span.written"), "`{selector}` makes cells of tables blocks");
        }
    }
    assert!(blocks > 0, "no rule is looked at");
    assert!(page.contains("<span class=\"written\">"));
}

/// The player of logs and the plotting library make up a fifth of a small page.
#[test]
fn a_page_without_logs_has_nothing_that_plays_them() {
    assert!(!page("arm.yaml", ARM).contains("uPlot"));
}

#[test]
fn a_faulty_description_gives_its_diagnostics_and_no_page() {
    let (page, diagnostics) =
        armgen_page::page(&Source::new("arm.yaml", ARM.replace("mass: 1", "mass: -1")), &[]).expect("no logs");
    assert!(page.is_none() && diagnostics.has_errors());
}

#[test]
fn nothing_of_a_name_or_an_expression_is_markup() {
    let name = "<!-- <script> \" ' \u{2028} <img src=x onerror=alert(1)>.yaml";
    let text = format!("# </script><script>commented()</script>\n{ARM}");
    let page = page(name, &text);
    assert!(!page.contains("commented()"), "comments of a description are no part of a page");
    // The head of the module, a comment of the script, contains the file name.
    assert_eq!(page.matches("<script").count(), 2);
    assert_eq!(page.matches("</script").count(), 2);
    assert!(!page.contains("<!--"));
}

/// The page explains in HTML why an arm with two joints more than rows has no determinant, and links to its measure of rank.
#[test]
fn nobody_is_sent_from_the_page_to_the_page() {
    let (head, joint) = ARM.trim_end().split_once("joints:\n").expect("joints");
    let joints: String = ["one", "two", "three", "four"].map(|name| format!("{}\n", joint.replace("only", name))).concat();
    let page = page("planar.yaml", &format!("{head}task: [x, y]\njoints:\n{joints}"));
    let (document, _) = page.split_once("<script").expect("a script");
    assert!(document.contains("<a href=\"#singular\">w = √det(J Jᵀ) among the numbers</a>"));
    assert!(!document.contains('`') && !document.contains("armgen page"));
}

/// Both steps together are the page: its module, its sections and its equations.
#[test]
fn the_second_step_brings_what_the_first_lacks() {
    for name in ["scara", "ur5"] {
        let path = format!("{}/../robots/{name}.yaml", env!("CARGO_MANIFEST_DIR"));
        let source = Source::new("arm.yaml", std::fs::read_to_string(path).expect("a description"));
        let whole = page("arm.yaml", source.text());
        let (first, _) = armgen_page::picture(&source, "abc");
        let first = first.expect("a valid description");
        let model = Model::new(validate::read(&source).0.expect("a valid description").0);
        let module = schedule::module(&model, &Options { trig: Trig::Fast, ..Options::default() });
        let rest = armgen_page::rest(&model, &module);
        let script = |page: &str| page.split_once(">globalThis.robot").map(|(_, script)| script.to_owned());
        assert!(script(&whole).is_some(), "{name}");
        assert_eq!(script(&whole), script(&first), "{name}");
        let data = |page: &str| -> serde_json::Value {
            let text = page.split_once("id=\"data\">").and_then(|(_, rest)| rest.split_once("</script>")).expect("data").0;
            serde_json::from_str(text).expect("JSON")
        };
        let mut both = data(&first);
        assert!(both["equations"].is_null(), "{name}");
        both["equations"] = rest["data"].clone();
        assert_eq!(both, data(&whole), "{name}");
        for section in ["equations", "cost"] {
            let content = rest[section].as_str().expect("a text");
            assert!(whole.contains(content) && !first.contains(content), "{name}: {section}");
        }
        assert_eq!(first.matches("data-later role").count(), 2, "{name}");
        assert_eq!(first.matches(" nonce=\"abc\"").count(), 2, "{name}");
    }
}

/// Sliders are of coordinates, with the limits of their followers; rows of all joints.
#[test]
fn a_page_of_coupled_joints_has_a_slider_for_each_coordinate() {
    let (head, first) = ARM.trim_end().split_once("  - ").expect("a joint");
    let second = first.replace("name: only", "name: mirror, parent: base, follows: {only: -2}, limits: {position: [-1, 3]}");
    let page = page("arm.yaml", &format!("{head}  - {second}\n  - {first}\ntip: only\n"));
    let text = page.split_once("id=\"data\">").and_then(|(_, rest)| rest.split_once("</script>")).expect("data").0;
    let data: serde_json::Value = serde_json::from_str(text).expect("JSON");
    let names = |key: &str| -> Vec<&str> {
        data[key].as_array().expect("rows").iter().map(|row| row["name"].as_str().expect("a name")).collect()
    };
    assert_eq!((names("rows"), names("links")), (vec!["only"], vec!["mirror", "only"]));
    assert_eq!(
        (&data["rows"][0]["limits"], &data["links"][1]["limits"]),
        (&serde_json::json!([-1.5, 0.5]), &serde_json::Value::Null)
    );
    assert_eq!(page.matches("<input type=\"range\" id=\"q").count(), 1);
    assert!(!page.contains("id=\"check\"") && page.contains("2 joints, 1 coordinate,"));
}
