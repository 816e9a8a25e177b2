//! Inverse kinematics through the runtime: all postures at a pose, and a branch followed along a path to where it ends.

use armgen_codegen::schedule::Options;
use armgen_codegen::source::Source;
use armgen_runtime::inverse_kinematics::{follow, follow_redundant, BranchEnd, Followed};
use armgen_runtime::nalgebra::{Matrix3, Matrix4, Rotation3, SMatrix, SVector, Vector2, Vector3};
use armgen_runtime::reference::Pose;
use armgen_runtime::robot::{InverseKinematics, JointRanges, Kinematics, Postures, RedundantInverseKinematics, Verdict};
use armgen_tests::project::{workspace, Project};

macro_rules! robot {
    ($module:ident, $ik:ident, $stem:literal) => {
        #[allow(dead_code, missing_docs, unreachable_pub, clippy::all)]
        mod $module {
            include!(concat!(env!("OUT_DIR"), "/", $stem, ".rs"));
            include!(concat!(env!("OUT_DIR"), "/", $stem, "_runtime.rs"));
        }
        #[allow(dead_code, missing_docs, unreachable_pub, clippy::all)]
        mod $ik {
            include!(concat!(env!("OUT_DIR"), "/", $stem, "_ik.rs"));
        }
    };
}

robot!(scara4, postures_scara4_f64_ik, "postures_scara4_f64");
robot!(scara4_single, postures_scara4_f32_ik, "postures_scara4_f32");
robot!(puma560, postures_puma560_f64_ik, "postures_puma560_f64");
robot!(ur5, postures_ur5_f64_ik, "postures_ur5_f64");
robot!(panda7, postures_panda7_f64_ik, "postures_panda7_f64");
robot!(iiwa14, postures_iiwa14_f64_ik, "postures_iiwa14_f64");

#[path = "postures/figures.rs"]
mod figures;

const SCARA: [f64; 4] = [0.3, 1.1, 0.2, 0.4];
const PUMA: [f64; 6] = [0.2, 0.5, -0.8, 0.7, 0.9, -0.4];

/// Every branch of these arms is a sign; branches of the general arm are not.
#[test]
fn signs_tell_branches_apart() {
    assert_eq!((scara4::Nominal.branch_signs(), puma560::Nominal.branch_signs(), ur5::Nominal.branch_signs()), (1, 7, 7));
}

/// The trait returns the result of the emitted function, in the runtime's types.
#[test]
fn the_trait_gives_what_the_function_gives() {
    let t = puma560::direct_kinematics(&PUMA);
    let found = postures_puma560_f64_ik::inverse_kinematics(&t);
    let postures = puma560::Nominal.inverse_kinematics(&Matrix4::from_fn(|i, j| t[i][j]));
    assert_eq!((postures.verdict, postures.count), (Verdict::Complete, 8));
    assert_eq!(found.count, 8);
    for (posture, solution) in postures.as_slice().iter().zip(found.as_slice()) {
        assert_eq!(posture.q, SVector::from(solution.q));
        assert_eq!((posture.branch, posture.double, posture.free), (solution.branch, false, 0));
        assert!(!postures_puma560_f64_ik::BRANCHES[usize::from(posture.branch)].is_empty());
    }
    let far = Matrix4::new_translation(&Vector3::new(9.0, 0.0, 0.0));
    let none = puma560::WithParameters::default().inverse_kinematics(&far);
    assert_eq!((none.verdict, none.count), (Verdict::Unreachable, 0));
    assert!(none.miss > 7.0 && none.miss < 9.5, "{}", none.miss);
}

/// The labels are signs. `elbow` is the sign of the angle between the links: q2 of the SCARA, whose loop is read backwards.
/// `wrist` is the sign of sin q5 of the Puma, whose loop is read forwards.
#[test]
fn branches_have_the_signs_that_they_say() {
    let labels = postures_scara4_f64_ik::BRANCHES;
    assert_eq!(labels, ["elbow up", "elbow down"]);
    for q in [SCARA, [0.3, -1.1, 0.2, 0.4]] {
        let found = postures_scara4_f64_ik::inverse_kinematics(&scara4::direct_kinematics(&q));
        for solution in found.as_slice() {
            assert_eq!(labels[usize::from(solution.branch)].ends_with("up"), solution.q[1] < 0.0, "{solution:?}");
        }
    }
    let found = postures_puma560_f64_ik::inverse_kinematics(&puma560::direct_kinematics(&PUMA));
    for solution in found.as_slice() {
        let label = postures_puma560_f64_ik::BRANCHES[usize::from(solution.branch)];
        assert_eq!(label.contains("wrist not flipped"), solution.q[4] > 0.0, "{label} {solution:?}");
    }
}

fn line<const N: usize>(
    robot: &impl Kinematics<N, Real = f64>,
    q: &SVector<f64, N>,
    by: Vector3<f64>,
) -> impl Fn(f64) -> Pose<f64> {
    let from = Pose::of(robot, q);
    move |s| Pose { position: from.position + by * s, ..from }
}

/// The SCARA's reach is a circle of 1 m: a straight line leaves it at a root of a quadratic equation.
#[test]
fn a_line_out_of_reach_ends_on_the_circle() {
    let start = SVector::from(SCARA);
    let path = line(&scara4::Nominal, &start, Vector3::new(1.2, -0.7, 0.1));
    let (p, v) = (path(0.0).position.xy(), Vector2::new(1.2, -0.7));
    let (a, b, c) = (v.norm_squared(), p.dot(&v), p.norm_squared() - 1.0);
    let leaves = (-b + (b * b - a * c).sqrt()) / a;
    let (mut asked, mut worst) = (0, 0.0f64);
    let ended = follow(&scara4::Nominal, &path, &start, 50, |s, q| {
        asked += 1;
        let there = Pose::of(&scara4::Nominal, q);
        worst = worst.max((there.position - path(s).position).amax()).max((there.rotation - path(s).rotation).amax());
        assert!(q[1] > 0.0, "the elbow stays");
    });
    assert_eq!(ended.end, Some(BranchEnd::Unreachable));
    assert!(ended.s <= leaves && leaves - ended.s < 1.1e-9, "{} {leaves}", ended.s);
    assert!(asked < 400 && worst < 1e-13, "{asked} {worst:e}");
}

/// The same in single precision, to its accuracy.
#[test]
fn in_single_precision_too() {
    let start = SVector::from(SCARA.map(|x| x as f32));
    let from = Pose::of(&scara4_single::Nominal, &start);
    let path = |s: f32| Pose { position: from.position + Vector3::new(2.0, 0.0, 0.0) * s, ..from };
    let leaves = ((1.0 - from.position.y * from.position.y).sqrt() - from.position.x) / 2.0;
    let ended = follow(&scara4_single::Nominal, path, &start, 50, |_, _| ());
    assert!(matches!(ended.end, Some(BranchEnd::Unreachable | BranchEnd::Singular)), "{ended:?}");
    assert!((ended.s - leaves).abs() < 2e-5, "{} {leaves}", ended.s);
}

/// Across axis 1 the equal links fold onto each other, and the first joint is free.
#[test]
fn a_line_through_the_first_axis_ends_there() {
    let start = SVector::from(SCARA);
    let position = Pose::of(&scara4::Nominal, &start).position;
    let path = line(&scara4::Nominal, &start, Vector3::new(-4.0 * position.x, -4.0 * position.y, 0.0));
    let ended = follow(&scara4::Nominal, &path, &start, 50, |_, _| ());
    assert!(matches!(ended.end, Some(BranchEnd::Singular | BranchEnd::Continuum)), "{ended:?}");
    assert!(ended.s <= 0.25 && 0.25 - ended.s < 1.1e-9, "{ended:?}");
    // Off the axis the branch continues, and the elbow with it.
    let path = line(&scara4::Nominal, &start, Vector3::new(-4.0 * position.x, -4.0 * position.y + 0.3, 0.0));
    let beside = follow(&scara4::Nominal, &path, &start, 50, |s, q| {
        assert!((Pose::of(&scara4::Nominal, q).position - path(s).position).amax() < 1e-13);
    });
    assert_eq!(beside.end, Some(BranchEnd::Unreachable));
}

/// det J of the Puma at q.
fn determinant(q: &SVector<f64, 6>) -> f64 {
    let j: SMatrix<f64, 6, 6> = puma560::Nominal.geometric_jacobian(q);
    j.determinant()
}

fn along(by: [f64; 6]) -> impl Fn(f64) -> SVector<f64, 6> {
    move |s| SVector::from(PUMA) + SVector::from(by) * s
}

fn followed(q: &impl Fn(f64) -> SVector<f64, 6>, each: impl FnMut(f64, &SVector<f64, 6>)) -> Followed<f64, 6> {
    follow(&puma560::Nominal, |s| Pose::of(&puma560::Nominal, &q(s)), &q(0.0), 100, each)
}

/// A motion of the joints that stays away from singular postures comes back from its poses; angles count beyond a half turn.
#[test]
fn a_regular_motion_comes_back_from_its_poses() {
    let q = along([5.0, 0.3, 0.25, 4.0, -0.4, -6.0]);
    let mut worst = 0.0f64;
    let ended = followed(&q, |s, found| worst = worst.max((found - q(s)).amax()));
    assert_eq!((ended.end, ended.s), (None, 1.0));
    assert!(worst < 1e-9, "{worst:e}");
}

/// Across the stretched elbow two postures meet: the branch ends where det J changes its sign.
#[test]
fn a_branch_ends_where_the_jacobian_is_singular() {
    let q = along([0.3, 0.2, 2.6, 0.1, 0.05, 0.2]);
    let (mut low, mut high) = (0.0, 1.0);
    assert!(determinant(&q(low)) * determinant(&q(high)) < 0.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        let same = determinant(&q(middle)) * determinant(&q(0.0)) > 0.0;
        (low, high) = if same { (middle, high) } else { (low, middle) };
    }
    let ended = followed(&q, |_, _| ());
    assert_eq!(ended.end, Some(BranchEnd::Singular));
    assert!((ended.s - low).abs() < 1e-5, "{} {low}", ended.s);
}

/// The Puma with limits for its first joint.
struct Limited;

impl Kinematics<6> for Limited {
    type Real = f64;
    fn direct_kinematics(&self, q: &SVector<f64, 6>) -> Matrix4<f64> {
        puma560::Nominal.direct_kinematics(q)
    }
    fn link_frames(&self, q: &SVector<f64, 6>) -> [Matrix4<f64>; 6] {
        puma560::Nominal.link_frames(q)
    }
    fn geometric_jacobian(&self, q: &SVector<f64, 6>) -> SMatrix<f64, 6, 6> {
        puma560::Nominal.geometric_jacobian(q)
    }
    fn geometric_jacobian_dot(&self, q: &SVector<f64, 6>, dq: &SVector<f64, 6>) -> SMatrix<f64, 6, 6> {
        puma560::Nominal.geometric_jacobian_dot(q, dq)
    }
}

impl InverseKinematics<6, 8> for Limited {
    fn inverse_kinematics(&self, pose: &Matrix4<f64>) -> Postures<f64, 6, 8> {
        puma560::Nominal.inverse_kinematics(pose)
    }
    fn branch_signs(&self) -> u16 {
        puma560::Nominal.branch_signs()
    }
}

impl JointRanges<6> for Limited {
    fn turns(&self) -> [bool; 6] {
        [true; 6]
    }
    fn position_limits(&self) -> [[f64; 2]; 6] {
        let mut limits = [[f64::NEG_INFINITY, f64::INFINITY]; 6];
        limits[0] = [-1.0, 0.65];
        limits
    }
}

/// Turned about the axis of joint 1, only that joint moves: it comes to its limit at a known place.
#[test]
fn a_limit_ends_a_branch() {
    let start = SVector::from(PUMA);
    let from = Limited.direct_kinematics(&start);
    let path = |s: f64| Pose::from_frame(&(Rotation3::from_axis_angle(&Vector3::z_axis(), s).to_homogeneous() * from));
    let ended = follow(&Limited, path, &start, 10, |_, _| ());
    assert_eq!(ended.end, Some(BranchEnd::Limit { joint: 0 }));
    assert!((ended.s - 0.45).abs() < 1.1e-9, "{}", ended.s);
    assert_eq!(follow(&puma560::Nominal, path, &start, 10, |_, _| ()).end, None);
}

/// Seven joints: a motion of them comes back from its poses and its redundancy; at any value of that the postures have the pose and the value.
fn redundant<R: RedundantInverseKinematics<7, 8, Real = f64>>(robot: &R) {
    let q = |s: f64| SVector::from([0.2 + 0.8 * s, 0.5, -0.3 + 0.4 * s, -1.2 - 0.5 * s, 0.4, 1.1 + 0.3 * s, 0.3 - 0.9 * s]);
    let path = |s| (Pose::of(robot, &q(s)), robot.redundancy(&q(s)));
    let mut worst = 0.0f64;
    let ended = follow_redundant(robot, path, &q(0.0), 100, |s, found| worst = worst.max((found - q(s)).amax()));
    assert_eq!((ended.end, ended.s), (None, 1.0));
    assert!(worst < 1e-9, "{worst:e}");
    let pose = robot.direct_kinematics(&q(0.0));
    let mut most = 0;
    for step in -8..8 {
        let value = robot.redundancy(&q(0.0)) + 0.05 * f64::from(step);
        let found = robot.inverse_kinematics(&pose, value);
        assert!(matches!(found.verdict, Verdict::Complete | Verdict::Unreachable), "{found:?}");
        for posture in found.as_slice() {
            assert!((robot.direct_kinematics(&posture.q) - pose).amax() < 1e-13);
            assert!((0.5 * (robot.redundancy(&posture.q) - value)).sin().abs() < 1e-12);
        }
        most = most.max(found.count);
    }
    assert_eq!(most, 8);
}

#[test]
fn seven_joints_are_followed_with_their_redundancy() {
    redundant(&panda7::Nominal);
    redundant(&iiwa14::Nominal);
    assert_eq!(panda7::Nominal.redundancy(&SVector::from([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.7])), 0.7);
    // The elbow of the iiwa above the line from shoulder to wrist, and turned by joint 1 and back by joint 3 below it.
    let [up, down] = [[0.0, 0.5, 0.0, -1.0, 0.0, 0.3, 0.0], [0.0, 0.5, 0.0, 1.0, 0.0, 0.3, 0.0]].map(SVector::from);
    let between = iiwa14::Nominal.redundancy(&up) - iiwa14::Nominal.redundancy(&down);
    assert!((between.abs() - core::f64::consts::PI).abs() < 1e-12, "{between}");
}

/// Turned about the axis of joint 7 with the elbow where it is, only that joint moves: to its limit at 175 degrees.
#[test]
fn a_limit_ends_a_branch_of_seven_joints() {
    let start = SVector::from([0.2, 0.5, -0.3, -1.2, 0.4, 1.1, 0.3]);
    let (from, swivel) = (iiwa14::Nominal.direct_kinematics(&start), iiwa14::Nominal.redundancy(&start));
    let turned = |s: f64| Pose::from_frame(&(from * Rotation3::from_axis_angle(&Vector3::z_axis(), 4.0 * s).to_homogeneous()));
    let ended = follow_redundant(&iiwa14::Nominal, |s| (turned(s), swivel), &start, 50, |_, _| ());
    assert_eq!(ended.end, Some(BranchEnd::Limit { joint: 6 }));
    let limit = (175f64.to_radians() - 0.3) / 4.0;
    assert!(ended.s <= limit && limit - ended.s < 1.1e-9, "{} {limit}", ended.s);
}

#[test]
fn what_is_no_path_is_said() {
    let start = SVector::from(PUMA);
    let robot = puma560::Nominal;
    let rest = Pose::of(&robot, &start);
    let end = |path: &dyn Fn(f64) -> Pose<f64>, start: &SVector<f64, 6>| {
        let ended = follow(&robot, path, start, 20, |_, _| ());
        (ended.end, ended.s)
    };
    assert_eq!(end(&|_| rest, &start), (None, 1.0));
    let other = postures_puma560_f64_ik::inverse_kinematics(&puma560::direct_kinematics(&[0.1, 0.4, -0.8, 0.7, 0.9, -0.4]));
    assert!(other.count == 8 && end(&|_| rest, &SVector::from(other.all[0].q)) == (Some(BranchEnd::Start), 0.0));
    let mut nan = start;
    nan[3] = f64::NAN;
    assert_eq!(end(&|_| rest, &nan).0, Some(BranchEnd::Invalid));
    let bent = Pose { rotation: Matrix3::new(1.0, 0.1, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0), ..rest };
    let (why, s) = end(&|s| if s < 0.5 { rest } else { bent }, &start);
    assert!(why == Some(BranchEnd::Invalid) && s < 0.5 && 0.5 - s < 1.1e-9);
    let turned = Rotation3::from_axis_angle(&Vector3::z_axis(), 2.0);
    let aside = Pose { position: turned * rest.position, rotation: turned * rest.rotation };
    let (why, s) = end(&|s| if s < 0.5 { rest } else { aside }, &start);
    assert!(why == Some(BranchEnd::Jump) && s < 0.5 && 0.5 - s < 1.1e-9, "{why:?} {s}");
}

/// The program of docs/inverse-kinematics.md, and the emitted test, in a project of their own.
#[test]
#[ignore = "wide"]
fn the_program_of_the_page_runs() {
    let page = std::fs::read_to_string(workspace().join("docs/inverse-kinematics.md")).expect("the page");
    let (_, program) = page.split_once("```rust\n").expect("a program");
    let (program, _) = program.split_once("```").expect("its end");
    let text = std::fs::read_to_string(workspace().join("robots/puma560.yaml")).expect("the Puma");
    let source = Source::new("puma560.yaml", text);
    let generated = armgen_codegen::generate(&source, &Options::default()).0.expect("a valid description");
    let project = Project::new(&std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("postures"), "page");
    project.write(
        "Cargo.toml",
        &format!(
            "[package]\nname = \"page\"\nversion = \"1.0.0\"\nedition = \"2021\"\n\n[dependencies]\nlibm = \"0.2\"\n\
             armgen-runtime = {{ path = {:?} }}\n\n[workspace]\n",
            workspace().join("runtime").display().to_string()
        ),
    );
    project.write("src/robot.rs", &generated.module);
    project.write("src/robot_ik.rs", &generated.inverse_kinematics());
    project.write("src/robot_runtime.rs", &generated.runtime_with_inverse_kinematics("robot_ik"));
    let tests = armgen_verify::test_kit(&source, &generated.module, "#[path = \"robot.rs\"]\nmod robot;").expect("tests");
    project.write("src/robot_test.rs", &(tests + &generated.solvers().next().expect("an end effector").test("robot_ik.rs")));
    project.write("src/main.rs", &format!("{program}\n#[cfg(test)]\nmod robot_test;\n"));
    let said = project.succeed(&["run", "--quiet"]);
    assert_eq!(said.matches("wrist flipped").count(), 4, "{said}");
    assert!(said.contains("of the line, then: "), "{said}");
    let tested = project.succeed(&["test", "--quiet", "inverse_kinematics"]);
    assert!(tested.contains("1 passed"), "{tested}");
}
