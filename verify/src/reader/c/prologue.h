#if defined(__FAST_MATH__) || defined(_M_FP_FAST) || defined(__ASSOCIATIVE_MATH__) || defined(__RECIPROCAL_MATH__)
#error "this file computes nonsense under -ffast-math, its parts and /fp:fast, which reorder sums: compile without"
#elif (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__ > 0) || defined(__NO_SIGNED_ZEROS__)
#error "this file takes what is no number for one under -ffinite-math-only, and zeros have other signs under -fno-signed-zeros: compile without"
#endif

/*
 * No multiplication is fused with an addition, whatever the flags: results have the same bits everywhere. (GCC fuses in the vectoriser of
 * straight lines even where it is told not to, so that this is off too. Clang does not say that it was given parts of -ffast-math, and is
 * told not to reorder; under -ffp-contract=fast it fuses all the same.) Where floats are kept with more digits than they have, as on the
 * x87, there are other bits, and ROBOT_SAME_BITS is 0.
 */
#if defined(__clang__) && __clang_major__ >= 13
#define ROBOT_UNFUSED _Pragma("STDC FP_CONTRACT OFF") _Pragma("clang fp reassociate(off)")
#elif defined(__clang__)
#define ROBOT_UNFUSED _Pragma("STDC FP_CONTRACT OFF")
#elif defined(__GNUC__)
#define ROBOT_UNFUSED
#pragma GCC push_options
#pragma GCC optimize("fp-contract=off", "no-tree-slp-vectorize", "no-unsafe-math-optimizations", "no-associative-math")
#elif defined(__STDC_VERSION__) && __STDC_VERSION__ >= 199901L
#define ROBOT_UNFUSED _Pragma("STDC FP_CONTRACT OFF")
#else
#define ROBOT_UNFUSED
#endif

#if defined(__FLT_EVAL_METHOD__) && __FLT_EVAL_METHOD__ != 0
#define ROBOT_SAME_BITS 0
#else
#define ROBOT_SAME_BITS 1
#endif

#if defined(__GNUC__)
#define ROBOT_INLINE static inline __attribute__((always_inline))
#else
#define ROBOT_INLINE static inline
#endif

