//! The robot of robot.yaml.
