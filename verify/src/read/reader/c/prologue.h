#if defined(__FAST_MATH__) || defined(_M_FP_FAST) || defined(__ASSOCIATIVE_MATH__) || defined(__RECIPROCAL_MATH__)
#error "this file computes nonsense under -ffast-math, its parts and /fp:fast, which reorder sums: compile without"
#elif (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__ > 0) || defined(__NO_SIGNED_ZEROS__)
#error "this file takes what is no number for one under -ffinite-math-only, and zeros have other signs under -fno-signed-zeros: compile without"
#endif

/*
 * For CUDA and HIP each function is one of the host and of the device. That a compiler for CUDA does not fuse on the device, no macro shows:
 * the program tells it by ARMGEN_FMAD, 0 under nvcc -fmad=false and clang -ffp-contract=off, 1 where it fuses and bits differ.
 */
#if defined(__HIPCC__) && !defined(__CUDACC__)
#include <hip/hip_runtime.h>
#endif
#if defined(__CUDACC__) || defined(__HIPCC__)
#pragma push_macro("inline")
#if defined(__CUDA_ARCH__) || defined(__HIP_DEVICE_COMPILE__)
#define inline __forceinline__ __host__ __device__
#else
#define inline inline __host__ __device__
#endif
#endif
#if defined(__CUDACC__) && !defined(ARMGEN_FMAD)
#error "nvcc fuses multiplications with additions: add -fmad=false -DARMGEN_FMAD=0 for the bits of the processor, or -DARMGEN_FMAD=1 for others"
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
#elif defined(__CUDA_ARCH__)
#define ROBOT_UNFUSED
#elif defined(__GNUC__)
#define ROBOT_UNFUSED
#pragma GCC push_options
#ifdef __NVCC__
#pragma nv_diagnostic push
#pragma nv_diag_suppress 1675
#endif
#pragma GCC optimize("fp-contract=off", "no-tree-slp-vectorize", "no-unsafe-math-optimizations", "no-associative-math")
#ifdef __NVCC__
#pragma nv_diagnostic pop
#endif
#elif defined(__STDC_VERSION__) && __STDC_VERSION__ >= 199901L
#define ROBOT_UNFUSED _Pragma("STDC FP_CONTRACT OFF")
#else
#define ROBOT_UNFUSED
#endif

#if (defined(__FLT_EVAL_METHOD__) && __FLT_EVAL_METHOD__ != 0) || (defined(__CUDACC__) && ARMGEN_FMAD != 0)
#define ROBOT_SAME_BITS 0
#else
#define ROBOT_SAME_BITS 1
#endif

#if defined(__GNUC__)
#define ROBOT_INLINE static inline __attribute__((always_inline))
#else
#define ROBOT_INLINE static inline
#endif

