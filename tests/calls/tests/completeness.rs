//! The program that proves the absence of panics calls every public function there is.

use armgen_bare_calls::{calls, calls_of_many_states, method_calls, named_functions, public_functions};
use armgen_codegen::{schedule::Options, source::Source, Generated};
use std::{collections::BTreeSet, fs, path::PathBuf};

fn project(path: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../..").join(path)
}

fn generated() -> Generated {
    generated_with(&Options::default())
}

fn generated_with(options: &Options) -> Generated {
    let text = fs::read_to_string(project("robots/scara.yaml")).expect("the robot is there");
    let (generated, _) = armgen_codegen::generate(&Source::new("scara.yaml", text), options);
    generated.expect("the description is valid")
}

fn missing(called: &str) -> BTreeSet<String> {
    let public = public_functions(&project("runtime/src/lib.rs"));
    public.difference(&named_functions(called)).cloned().collect()
}

#[test]
fn every_public_function_of_the_runtime_is_called() {
    let steps = ["runtime.rs", "timing.rs"].map(|file| fs::read_to_string(project("tests/bare/no_panic/src").join(file)));
    // One file may have comments on itself only at its start.
    let called =
        steps.map(|text| text.expect("the calls are there").replace("//!", "//")).concat() + &method_calls(&generated().runtime);
    assert_eq!(missing(&called), BTreeSet::new(), "these are not called by tests/bare/no_panic/src");
    // The check detects an omission of each kind.
    for name in ["manipulability", "left_singular", "NullSpace::new", "Dynamics::gravity", "Path::check_reach", "Clik::approach"]
    {
        let forgotten = called.replace(&format!("{name}("), "drop(");
        assert_eq!(missing(&forgotten), BTreeSet::from([name.to_owned()]));
    }
}

#[test]
fn every_public_function_of_an_emitted_module_is_called() {
    let module = generated().module;
    let named = named_functions(&calls(&module));
    // Read off the text by its lines, another way than `calls` goes.
    let functions: Vec<&str> = module.lines().filter_map(|line| line.strip_prefix("pub fn ")?.split('(').next()).collect();
    assert!(functions.len() > 20, "{functions:?}");
    for function in functions {
        assert!(named.contains(function), "{function} is not called");
    }
}

#[test]
fn every_function_for_many_states_is_called() {
    let module = generated_with(&Options { batch: Some(8), ..Options::default() }).module;
    let called = calls_of_many_states(&module);
    let (_, lanes) = module.split_once("pub mod lanes {").expect("lanes");
    let (lanes, batch) = lanes.split_once("pub mod batch {").expect("batch");
    for (of, text) in [("lanes", lanes), ("batch", batch)] {
        let functions: Vec<&str> = text.lines().filter_map(|line| line.strip_prefix("    pub fn ")?.split('(').next()).collect();
        assert!(functions.len() > 20, "{functions:?}");
        for function in functions {
            assert!(called.contains(&format!("{of}::{function}(")), "{of}::{function} is not called");
        }
    }
}
