#pragma once

/// Compiles a function twice, for any processor and for one with 256-bit vectors, and takes the
/// better one when the program is loaded. Both give the same bits: products and sums are never
/// fused, and sums keep their order.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define WAYMARK_VECTOR_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define WAYMARK_VECTOR_CLONES
#endif
