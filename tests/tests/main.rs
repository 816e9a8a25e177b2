//! The emitted modules, and the project around them. One program for all tests of the crate: the other files of this folder are its modules.

mod bad_files;
mod batches;
mod c_face;
mod embedding;
mod emission;
mod emitted;
mod exported_arms;
mod general_angles;
mod gravity;
mod hostile_files;
mod import_bounds;
mod kinematics_alone;
mod latex;
mod layers;
mod named_files;
mod oracle;
mod panda7_control;
mod passes;
mod posed_arms;
mod postures;
mod random_arms;
mod random_arms_exact;
mod robot_yaml_page;
mod shown;
mod snapshots;
mod technical_project;
