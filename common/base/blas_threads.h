#pragma once

namespace pangaea {

// OpenBLAS, which Ceres and SuiteSparse factor with, brings a thread for each core, and those spin while they wait for
// each other: the programs have threads of their own, and their matrices are small. After this it computes on the
// thread that calls it, unless whoever started the program asked for something else by OPENBLAS_NUM_THREADS or
// OMP_NUM_THREADS. (Its threads were made when it was loaded and sleep from then on.) Nothing happens where another
// BLAS is linked. At the begin of main, before it is used.
void UseOneBlasThread();

}  // namespace pangaea
