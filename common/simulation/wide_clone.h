#pragma once

// Marks a function of which a second copy for AVX2 is compiled and chosen when the program starts. The copies have no
// fused multiply-add, so that every processor rounds alike and pictures have the same bytes everywhere. Sanitizers
// start after the choosing, and clang chooses in another way: both get the plain copy.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define PANGAEA_WIDE_CLONE __attribute__((target_clones("avx2", "default")))
#else
#define PANGAEA_WIDE_CLONE
#endif
