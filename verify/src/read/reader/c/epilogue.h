#if defined(__CUDACC__) || defined(__HIPCC__)
#pragma pop_macro("inline")
#endif
#if defined(__GNUC__) && !defined(__clang__) && !defined(__CUDA_ARCH__)
#pragma GCC pop_options
#endif

#endif
