//! Arms whose angles are all general decimals: what their constants take grows with the joints as for right angles.
//!
//! Multiplied out, a product of rotations by general angles would double its terms with each rotation. The test bounds four
//! counts: terms of constants, definitions that they share, lengths of their texts, and operations of the functions.

use armgen_codegen::exact::Definitions;
use armgen_codegen::program::Cost;
use armgen_codegen::schedule::{self, Options, Selection};
use armgen_codegen::source::Source;
use armgen_codegen::{validate, Model};
use armgen_tests::random::chain_with_general_angles;

/// Size of the constants of an arm's functions.
#[derive(Debug)]
struct Size {
    /// Terms of the longest constant.
    terms: usize,
    definitions: usize,
    /// Characters of all formulas, definitions included.
    length: usize,
    operations: usize,
}

fn size(joints: &str, functions: &[&str]) -> Size {
    let source = Source::new("robot.yaml", chain_with_general_angles(joints));
    let (manipulator, _) = validate::read(&source).0.expect("a valid arm");
    let functions = Selection::named(functions.iter().copied()).expect("names of functions");
    let module = schedule::module(&Model::new(manipulator), &Options { functions, ..Options::default() });
    let mut definitions = Definitions::default();
    let constants: Vec<_> = module.constants().into_values().flatten().collect();
    let formulas: usize = constants.iter().map(|constant| definitions.formula(constant).len()).sum();
    let costs = module.functions.iter().map(Cost::of);
    Size {
        terms: constants.iter().map(|constant| constant.terms().count()).max().unwrap_or(0),
        definitions: definitions.texts().len(),
        length: formulas + definitions.texts().iter().map(String::len).sum::<usize>(),
        operations: costs.map(|cost| cost.mul + cost.add + cost.div).sum(),
    }
}

/// Sizes as the number of joints doubles: each at most this factor times the one before. They grow with about the third power of
/// the joints; exponential growth would square them.
#[track_caller]
fn check(kind: &str, joints: [usize; 3], functions: &[&str], most: usize) {
    let sizes = joints.map(|n| size(&kind.repeat(n), functions));
    assert!(sizes.iter().all(|size| size.terms <= 32), "{sizes:?}");
    for pair in sizes.windows(2) {
        let (before, after) = (&pair[0], &pair[1]);
        assert!(after.definitions <= most * before.definitions + 50, "{sizes:?}");
        assert!(after.length <= most * before.length, "{sizes:?}");
        assert!(after.operations <= most * before.operations, "{sizes:?}");
    }
}

const DYNAMICS: [&str; 4] = ["inertia_matrix", "gravity", "inverse_dynamics", "forward_dynamics"];

#[test]
fn constants_of_revolute_arms_grow_with_their_joints() {
    // Lengths 11, 51 and 206 thousand; 24 joints have 559.
    check("r", [3, 6, 12], &DYNAMICS, 6);
}

#[test]
fn constants_of_prismatic_arms_grow_with_their_joints() {
    // Lengths 37, 197 and 1233 thousand; 32 joints have 5603.
    check("p", [4, 8, 16], &DYNAMICS, 8);
}

#[test]
#[ignore = "wide"]
fn constants_of_mixed_arms_grow_with_their_joints() {
    // Lengths 52, 969 and 10007 thousand; 32 joints have 56078. Those of 4 joints are almost all multiplied out.
    check("rp", [2, 4, 8], &["equations_of_motion", "base_regressor"], 20);
}
