//! The rows of a description: each value with its source text, number and line.

use armgen_codegen::derive::parameters::{denavit_hartenberg, nominal};
use armgen_codegen::description::{
    list_text, Convention, JointDescription, PoseDescription, PoseElement, RobotDescription, RotationDescription,
};
use armgen_codegen::document::Expression;
use armgen_codegen::kinds::JointKind;
use armgen_codegen::manipulator::{Joint, Manipulator, Placement, Pose};
use armgen_codegen::source::Source;

/// A pose in another frame: [R p], 3×4.
pub(crate) type Frame = [[f64; 4]; 3];

pub(crate) struct Row {
    /// Name of the joint.
    pub(crate) name: String,
    /// Whether the joint is revolute.
    pub(crate) revolute: bool,
    /// a, alpha, d, theta; `None` for rows of the convention urdf.
    pub(crate) denavit_hartenberg: Option<[Value; 4]>,
    /// Source text of origin and axis, for rows of the convention urdf.
    pub(crate) urdf: Option<[String; 2]>,
    /// The link that carries the row, none for the base, and the frame in it that the row starts from; only where the arm branches.
    pub(crate) branch: Option<(Option<usize>, Frame)>,
    /// Elementary transforms before the motion, from the previous frame; those of the first row start at the frame that `base` gives.
    pub(crate) before: Vec<Frame>,
    /// Direction of the joint axis after these transforms.
    pub(crate) axis: [f64; 3],
    /// Elementary transforms after the motion.
    pub(crate) after: Vec<Frame>,
    /// Lowest and highest position.
    pub(crate) limits: Option<[f64; 2]>,
    /// Source text of the limits.
    pub(crate) limits_written: String,
    /// Line of the row in the file.
    pub(crate) line: usize,
}

/// A value of a row.
pub(crate) struct Value {
    /// Its source text.
    pub(crate) written: String,
    /// In m or rad.
    pub(crate) number: f64,
}

/// The convention of a description; standard DH by default.
pub(crate) fn convention(description: &RobotDescription) -> Convention {
    description.convention.as_ref().map_or(Convention::Standard, |convention| convention.value)
}

pub(crate) fn rows(source: &Source, description: &RobotDescription, manipulator: &Manipulator) -> Vec<Row> {
    let written = description.joints.iter().flat_map(|joints| &joints.value);
    let convention = convention(description);
    let joints = manipulator.joints.iter().zip(written).zip(manipulator.parents());
    let branches = manipulator.branches();
    let branch = |joint: &Joint, parent| {
        let start = joint.row.before.elements[..elements_before(joint, convention)].to_vec();
        branches.then(|| (parent, frame(manipulator, &Pose::new(start).frame)))
    };
    joints
        .map(|((joint, written), parent)| Row {
            branch: branch(joint, parent),
            ..row(source, manipulator, convention, joint, written)
        })
        .collect()
}

/// The frame in which the first row starts, relative to the base frame.
pub(crate) fn base(manipulator: &Manipulator, description: &RobotDescription) -> Frame {
    let elements = &manipulator.joints[0].row.before.elements;
    let count = elements_before(&manipulator.joints[0], convention(description));
    frame(manipulator, &Pose::new(elements[..count].to_vec()).frame)
}

/// The number of transforms before a motion that belong to `base` and `mount`, not to the row.
fn elements_before(joint: &Joint, convention: Convention) -> usize {
    let elements = joint.row.before.elements.len();
    match convention {
        Convention::Standard => elements - 1,
        Convention::Modified => elements - 2,
        // Those transforms and the ones of the origin cannot be told apart.
        Convention::Urdf => 0,
    }
}

fn row(source: &Source, manipulator: &Manipulator, convention: Convention, joint: &Joint, written: &JointDescription) -> Row {
    let frames = |elements: &[Placement]| -> Vec<Frame> { elements.iter().map(|e| frame(manipulator, e)).collect() };
    let before = &joint.row.before.elements[elements_before(joint, convention)..];
    let text = |value: &Option<Expression>| value.as_ref().map_or(String::new(), |v| v.text(source));
    let numbers = match convention {
        Convention::Standard | Convention::Modified => {
            denavit_hartenberg(manipulator, &joint.row, convention == Convention::Modified)
        }
        Convention::Urdf => None,
    };
    let denavit_hartenberg = numbers.map(|[a, alpha, d, theta]| {
        let value = |value, number| Value { written: text(value), number };
        [value(&written.a, a), value(&written.alpha, alpha), value(&written.d, d), value(&written.theta, theta)]
    });
    Row {
        name: joint.name.clone(),
        branch: None,
        revolute: joint.kind == JointKind::Revolute,
        denavit_hartenberg,
        urdf: (convention == Convention::Urdf).then(|| {
            let axis = written.axis.as_ref().map_or(String::new(), |axis| source.slice(axis.span).to_string());
            [pose_text(source, written.origin.as_ref()), axis]
        }),
        before: frames(before),
        axis: joint.row.axis.each_ref().map(armgen_codegen::exact::Number::to_f64),
        after: frames(&joint.row.after.elements),
        limits: joint.limits.position.as_ref().map(|limits| limits.each_ref().map(armgen_codegen::exact::Number::to_f64)),
        limits_written: written.limits.position.as_ref().map_or(String::new(), |limits| list_text(limits, source)),
        line: source.place(written.span.start).line,
    }
}

/// The source text of a pose on a single line: translations, and rotations with their key.
fn pose_text(source: &Source, pose: Option<&PoseDescription>) -> String {
    let rotation = |rotation: &RotationDescription| match rotation {
        RotationDescription::Rpy(rpy) => format!("rpy {}", list_text(rpy, source)),
        RotationDescription::Quat(quat) => format!("quat {}", source.slice(quat.span)),
        RotationDescription::AxisAngle(axis, angle) => {
            format!("axis {} angle {}", source.slice(axis.span), angle.text(source))
        }
        RotationDescription::XyAxes(axes) => format!("xyaxes {}", source.slice(axes.span)),
    };
    let element = |element: &PoseElement| {
        let xyz = element.xyz.as_ref().map(|xyz| list_text(xyz, source));
        xyz.into_iter().chain(element.rotation.as_ref().map(rotation)).collect::<Vec<_>>()
    };
    pose.into_iter().flat_map(|pose| &pose.elements).flat_map(element).collect::<Vec<_>>().join(", ")
}

/// The numeric value of a placement at the description's parameters.
pub(crate) fn frame(manipulator: &Manipulator, placement: &Placement) -> Frame {
    std::array::from_fn(|i| {
        std::array::from_fn(|j| match j {
            3 => nominal(manipulator, &placement.translation[i]).to_f64(),
            _ => placement.rotation[i][j].to_f64(),
        })
    })
}
