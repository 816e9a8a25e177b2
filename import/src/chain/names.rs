//! The meaning of names of links and joints: frames of tools, and fingers.

/// Words of names of a tool's frame, the likeliest first; a name may need two adjacent words.
const TOOLS: [&[&str]; 16] = [
    &["tcp"],
    &["tool0"],
    &["tool", "center"],
    &["gripper", "frame"],
    &["gripperframe"],
    &["grasp"],
    &["ee"],
    &["eef"],
    &["end", "effector"],
    &["endeffector"],
    &["tool", "frame"],
    &["tool"],
    &["pinch"],
    &["flange"],
    &["attachment", "site"],
    &["attachment"],
];

/// Words of joints and links that a gripper moves.
const FINGERS: [&str; 5] = ["finger", "jaw", "claw", "thumb", "knuckle"];

/// The words of a name, in lower case: parted by other characters and before capitals.
fn words(name: &str) -> Vec<String> {
    let (mut words, mut lower) = (vec![String::new()], false);
    for c in name.chars().take(256) {
        if !c.is_alphanumeric() || (c.is_uppercase() && lower) {
            words.push(String::new());
        }
        lower = c.is_lowercase();
        if c.is_alphanumeric() {
            words.last_mut().expect("there is one").extend(c.to_lowercase());
        }
    }
    words.retain(|word| !word.is_empty());
    words
}

/// How likely a name is that of a tool's frame: the less, the likelier.
pub(super) fn tool(name: &str) -> Option<usize> {
    let words = words(name);
    let fits = |tool: &&[&str]| words.windows(tool.len()).any(|some| some.iter().eq(tool.iter()));
    TOOLS.iter().position(fits)
}

/// Whether a joint of such names moves a finger. A gripper may be a link of the arm, so of links that word alone is no sign.
pub(super) fn finger(joint: &str, link: &str) -> bool {
    let any = |name: &str| words(name).iter().any(|word| FINGERS.iter().any(|finger| word.contains(finger)));
    any(joint) || any(link) || words(joint).iter().any(|word| word == "gripper")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_tools_and_fingers() {
        let likely =
            ["panda_hand_tcp", "tool0", "gripper_frame_link", "gripperframe", "ee_link", "endEffector", "tool_link", "flange"];
        let ranks: Vec<Option<usize>> = likely.iter().map(|name| tool(name)).collect();
        assert!(ranks.iter().all(Option::is_some) && ranks.is_sorted(), "{ranks:?}");
        for name in ["wrist_3_link", "moving_jaw", "base", "knee", "steel", "toolbox", "gripper", "link7"] {
            assert_eq!(tool(name), None, "{name}");
        }
        for (joint, link) in [("gripper", "l6"), ("j6", "moving_jaw_so101_v1"), ("panda_finger_joint1", "x"), ("leftClaw", "x")] {
            assert!(finger(joint, link), "{joint} {link}");
        }
        for (joint, link) in [("joint_6", "gripper_base"), ("wrist_3", "wrist_3_link"), ("", "")] {
            assert!(!finger(joint, link), "{joint} {link}");
        }
    }
}
