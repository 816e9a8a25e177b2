//! `armgen check --format sarif`: the diagnostics in the Static Analysis Results Interchange Format 2.1.0 (OASIS, 2020), for code
//! scanning.

use std::collections::BTreeMap;
use std::path::Path;

use armgen_codegen::diagnostic::{AnyCode, Diagnostic, Label};
use armgen_codegen::source::Source;
use serde_json::{json, Value};

use super::judged::Judged;

pub(super) fn document(files: &[Judged]) -> Value {
    let found = || files.iter().flat_map(|file| file.diagnostics.iter().map(move |diagnostic| (diagnostic, &file.source)));
    let codes: BTreeMap<&str, AnyCode> = found().map(|(diagnostic, _)| (diagnostic.code.name(), diagnostic.code)).collect();
    let index = |diagnostic: &Diagnostic| codes.keys().position(|name| *name == diagnostic.code.name());
    let results: Vec<Value> = found().map(|(diagnostic, source)| result(diagnostic, index(diagnostic), source)).collect();
    json!({
        "$schema": "https://json.schemastore.org/sarif-2.1.0.json",
        "version": "2.1.0",
        "runs": [{
            "tool": { "driver": {
                "name": "armgen",
                "version": env!("CARGO_PKG_VERSION"),
                "rules": codes.values().map(rule).collect::<Vec<_>>(),
            } },
            "columnKind": "unicodeCodePoints",
            "results": results,
        }],
    })
}

fn rule(code: &AnyCode) -> Value {
    json!({
        "id": code.name(),
        "shortDescription": { "text": code.about() },
        "defaultConfiguration": { "level": code.severity().name() },
    })
}

fn result(diagnostic: &Diagnostic, rule: Option<usize>, source: &Source) -> Value {
    let Diagnostic { code, message, labels, help } = diagnostic;
    let mut result = json!({
        "ruleId": code.name(),
        "ruleIndex": rule,
        "level": code.severity().name(),
        "message": { "text": format!("{message}\nhelp: {help}") },
        "locations": [location(&labels[0], source)],
    });
    if labels.len() > 1 {
        result["relatedLocations"] = labels[1..].iter().map(|label| location(label, source)).collect();
    }
    result
}

fn location(label: &Label, source: &Source) -> Value {
    let (start, end) = (source.place(label.span.start), source.place(label.span.end));
    let mut location = json!({ "physicalLocation": {
        "artifactLocation": { "uri": uri(source.name()) },
        "region": { "startLine": start.line, "startColumn": start.column, "endLine": end.line, "endColumn": end.column },
    } });
    if !label.text.is_empty() {
        location["message"] = json!({ "text": label.text });
    }
    location
}

/// The path as a reference of RFC 3986, relative if the path is.
fn uri(path: &str) -> String {
    let slashes = if cfg!(windows) { path.replace('\\', "/") } else { path.to_owned() };
    let encoded: String = slashes
        .bytes()
        .map(|byte| match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'.' | b'_' | b'~' | b'/' => char::from(byte).to_string(),
            _ => format!("%{byte:02X}"),
        })
        .collect();
    match Path::new(path).is_absolute() {
        true => format!("file:///{}", encoded.trim_start_matches('/')),
        false => encoded,
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn paths_become_references() {
        for (path, uri) in
            [("robots/ur5.yaml", "robots/ur5.yaml"), ("my arm:1.yaml", "my%20arm%3A1.yaml"), ("\u{e4}.yaml", "%C3%A4.yaml")]
        {
            assert_eq!(super::uri(path), uri);
        }
        if cfg!(unix) {
            assert_eq!(super::uri("/tmp/a.yaml"), "file:///tmp/a.yaml");
        }
    }
}
