//! The checker's table of functions and the generator's catalogue are written independently and must agree.

use armgen_codegen::catalogue::{self, Argument, Quantity};
use armgen_verify::textbook::reference::PROMISES;

/// The Rust type of a result in the catalogue, without blanks, and the names of its fields.
fn result(quantity: &Quantity) -> (String, Vec<String>) {
    let parts = quantity
        .result
        .iter()
        .map(|part| part.lengths.iter().rev().fold("Real".to_string(), |of, length| format!("[{of};{}]", length.constant())));
    let parts: Vec<String> = parts.collect();
    match (quantity.structure, parts.as_slice()) {
        (Some(structure), _) => (structure.name.into(), quantity.result.iter().map(|part| format!(".{}", part.name)).collect()),
        (None, [one]) => (one.clone(), vec![String::new()]),
        (None, parts) => (format!("({})", parts.join(",")), (0..parts.len()).map(|i| format!(".{i}")).collect()),
    }
}

#[test]
fn the_checker_and_the_catalogue_know_the_same_functions() {
    let declared: Vec<&str> = catalogue::quantities().map(|quantity| quantity.name).collect();
    let known: Vec<&str> = PROMISES.iter().map(|promise| promise.name).collect();
    assert_eq!(known, declared);
    let sizes = armgen_verify::values::contract::Sizes { n: 2, joints: None, p: 3, b: 4, m: 5, gravity: false, tips: Vec::new() };
    for (promise, quantity) in PROMISES.iter().zip(catalogue::quantities()) {
        let name = promise.name;
        let arguments: Vec<&str> = quantity.arguments.iter().copied().map(Argument::name).collect();
        assert_eq!(promise.arguments, arguments, "{name}");
        assert_eq!(promise.parameters, quantity.has_parameters, "{name}");
        let (kind, fields) = result(quantity);
        // Without coupled joints, a module has no JOINTS beside DOF.
        assert_eq!(promise.returned.rust().replace("JOINTS", "DOF"), kind.replace("JOINTS", "DOF"), "{name}");
        let places = promise.returned.places(&sizes);
        let of = catalogue::Sizes { dof: 2, joints: 2, parameters: 3, base_parameters: 4, task: 5 };
        assert_eq!(places.len(), quantity.result.iter().map(|part| part.len(&of)).sum::<usize>(), "{name}");
        assert!(places.iter().all(|place| fields.iter().any(|field| place.starts_with(field.as_str()))), "{name}: {places:?}");
    }
}
