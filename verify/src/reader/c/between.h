/* With ROBOT_NO_MATH_H defined no header is needed: sines of angles beyond the range of the ones below are then not numbers. */
#ifdef ROBOT_NO_MATH_H
/* Name of the robot, and whether each joint turns (q in rad) or slides (q in m). */
#define ROBOT_NAME
/* The scalar of all functions. */
typedef
/* Number of joints, of parameters, and of rows of the operational space. */
#define ROBOT_DOF
/* Rows of the geometric Jacobian in the operational space: 0 1 2 velocity along, 3 4 5 angular velocity about x y z. */
#define ROBOT_TASK
/* Initialisers of arrays. Limits are rad or m, per s, N m or N; infinite (math.h) where the description gives none. */
#define ROBOT_JOINT_NAMES
/* Arrays are by rows. A result may lie where arguments do, but not where another result does. */
static inline
