// Solvers of square sparse systems by other libraries, behind one interface.
#pragma once

// Matrix compressed by columns, borrowed from the caller for as long as the solver lives. Numbers are single doubles, or
// pairs (real part, imaginary part) if is_complex; vectors likewise.
struct Matrix {
    int size;
    int is_complex;
    const int* starts;   // size + 1
    const int* rows;     // rising within a column
    const double* values;
    const double* signs; // one per unknown: how the diagonal must be shifted to make the matrix quasi-definite
};

// Each step returns 0, or the status the library gave. Destructors free everything.
class Peer {
public:
    virtual ~Peer() = default;
    virtual int analyse() = 0;
    virtual int factor() = 0;
    virtual int solve(const double* b, double* x) = 0;
};

// options: {strategy, ordering, steps of refinement}, numbers of umfpack.h
Peer* new_umfpack(const Matrix& a, const double* options);
// options: {ordering, block triangular form or not}, numbers of klu.h
Peer* new_klu(const Matrix& a, const double* options);
// options: {0 COLAMD, 1 AMD; symmetric mode or not; pivot threshold}
Peer* new_sparse_lu(const Matrix& a, const double* options);
// options: {steps of refinement, shift of the diagonal}
Peer* new_ldlt(const Matrix& a, const double* options);
