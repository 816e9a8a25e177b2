//! Names of elements and attributes, as the schema of MuJoCo has them (`MJCF` in its `xml_native_reader.cc`, versions 2 and 3), of the parts
//! that are read. MuJoCo refuses a file with others; here they are warned of, since a later version may have them.

use armgen_codegen::diagnostic::Diagnostics;
use roxmltree::Node;

use super::sections;
use crate::unread;

/// The elements in `worldbody`, in a body or in a frame.
const INSIDE: &[&str] = &[
    "body",
    "frame",
    "inertial",
    "joint",
    "freejoint",
    "geom",
    "site",
    "camera",
    "light",
    "plugin",
    "attach",
    "composite",
    "flexcomp",
    "replicate",
    "include",
];

const ELEMENTS_OF: [(&str, &[&str]); 5] = [
    (
        "mujoco",
        &[
            "compiler",
            "option",
            "size",
            "statistic",
            "visual",
            "default",
            "extension",
            "custom",
            "asset",
            "worldbody",
            "deformable",
            "contact",
            "equality",
            "tendon",
            "actuator",
            "sensor",
            "keyframe",
            "include",
        ],
    ),
    ("worldbody", INSIDE),
    ("body", INSIDE),
    ("frame", INSIDE),
    (
        "default",
        &[
            "default",
            "joint",
            "geom",
            "site",
            "mesh",
            "material",
            "camera",
            "light",
            "pair",
            "equality",
            "tendon",
            "general",
            "motor",
            "position",
            "velocity",
            "intvelocity",
            "damper",
            "cylinder",
            "muscle",
            "adhesion",
            "dcmotor",
            "plugin",
            "include",
        ],
    ),
];

#[rustfmt::skip]
const ATTRIBUTES_OF: [(&str, &[&str]); 10] = [
    ("compiler", &[
        "autolimits", "boundmass", "boundinertia", "settotalmass", "balanceinertia", "strippath", "coordinate", "angle", "fitaabb", "eulerseq",
        "meshdir", "texturedir", "discardvisual", "usethread", "fusestatic", "inertiafromgeom", "inertiagrouprange", "saveinertial", "assetdir",
        "alignfree", "convexhull", "exactmeshinertia",
    ]),
    ("option", &[
        "timestep", "apirate", "impratio", "tolerance", "ls_tolerance", "noslip_tolerance", "ccd_tolerance", "mpr_tolerance",
        "sleep_tolerance", "gravity", "wind", "magnetic", "density", "viscosity", "o_margin", "o_solref", "o_solimp", "o_friction",
        "integrator", "collision", "cone", "jacobian", "solver", "iterations", "ls_iterations", "noslip_iterations", "ccd_iterations",
        "mpr_iterations", "sdf_iterations", "sdf_initpoints", "actuatorgroupdisable",
    ]),
    ("flag", &[
        "constraint", "equality", "frictionloss", "limit", "contact", "passive", "spring", "damper", "gravity", "clampctrl", "warmstart",
        "filterparent", "actuation", "refsafe", "sensor", "midphase", "nativeccd", "island", "eulerdamp", "autoreset", "override", "energy",
        "fwdinv", "invdiscrete", "multiccd", "sleep", "sensornoise",
    ]),
    ("default", &["class"]),
    ("body", &[
        "name", "childclass", "pos", "quat", "axisangle", "xyaxes", "zaxis", "euler", "mocap", "gravcomp", "sleep", "user",
    ]),
    ("frame", &["name", "childclass", "pos", "quat", "axisangle", "xyaxes", "zaxis", "euler"]),
    ("inertial", &["pos", "quat", "axisangle", "xyaxes", "zaxis", "euler", "mass", "diaginertia", "fullinertia"]),
    ("joint", &[
        "name", "class", "type", "group", "pos", "axis", "springdamper", "limited", "actuatorfrclimited", "solreflimit", "solimplimit",
        "solreffriction", "solimpfriction", "stiffness", "range", "actuatorfrcrange", "actuatorgravcomp", "margin", "ref", "springref",
        "armature", "damping", "frictionloss", "user",
    ]),
    ("freejoint", &["name", "group", "align"]),
    ("site", &[
        "name", "class", "type", "group", "pos", "quat", "axisangle", "xyaxes", "zaxis", "euler", "material", "size", "fromto", "rgba", "user",
    ]),
];

/// The elements that a body has once.
const SINGLE: [(&str, &[&str]); 1] = [("body", &["inertial"])];

/// Warns of what nothing reads of the sections that are read.
pub(super) fn warn_of_unread<'a, 'i: 'a>(root: Node<'a, 'i>, diagnostics: &mut Diagnostics) {
    let read = ["compiler", "option", "default", "worldbody"].into_iter().flat_map(|name| sections(root, name));
    // An element that replaces others has names of its own, and is refused.
    let written_out = |node: &Node<'a, 'i>| {
        !node.ancestors().skip(1).any(|outer| ["composite", "flexcomp", "replicate"].contains(&outer.tag_name().name()))
    };
    let inside: Vec<Node<'a, 'i>> =
        read.flat_map(|section| section.descendants()).filter(|node| node.is_element() && written_out(node)).collect();
    let inside = inside.iter().copied();
    unread::warn_of_elements(std::iter::once(root).chain(inside.clone()), &ELEMENTS_OF, diagnostics);
    unread::warn_of_repeated(inside.clone(), &SINGLE, diagnostics);
    unread::warn_of_attributes(inside, &ATTRIBUTES_OF, diagnostics);
}
