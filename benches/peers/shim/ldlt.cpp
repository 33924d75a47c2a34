#include "eigen.h"

#include <Eigen/SparseCholesky>

namespace {

// Factors the shifted matrix, which needs no pivots, and refines on the true one.
template <class T> class Ldlt final : public Peer {
public:
    Ldlt(const Matrix& matrix, const double* options)
        : a(copy_of<T>(matrix)), shifted(a), refinements(static_cast<int>(options[0])) {
        Sparse<T> diagonal(matrix.size, matrix.size);
        diagonal.reserve(Eigen::VectorXi::Constant(matrix.size, 1));
        for (int i = 0; i < matrix.size; ++i) {
            diagonal.insert(i, i) = T(matrix.signs[i] * options[1]);
        }
        shifted += diagonal;
    }

    int analyse() override {
        ldlt.analyzePattern(shifted);
        return 0;
    }

    int factor() override {
        ldlt.factorize(shifted);
        return ldlt.info();
    }

    int solve(const double* b, double* x) override {
        auto size = static_cast<int>(a.rows());
        auto target = view<T>(b, size);
        Vector<T> solution = ldlt.solve(target);
        for (int step = 0; step < refinements; ++step) {
            Vector<T> residual = target - a * solution;
            solution += ldlt.solve(residual);
        }
        view<T>(x, size) = solution;
        return ldlt.info();
    }

private:
    Sparse<T> a;
    Sparse<T> shifted;
    int refinements;
    Eigen::SimplicialLDLT<Sparse<T>, Eigen::Lower, Eigen::AMDOrdering<int>> ldlt;
};

} // namespace

Peer* new_ldlt(const Matrix& a, const double* options) {
    if (a.is_complex) {
        return new Ldlt<std::complex<double>>(a, options);
    }
    return new Ldlt<double>(a, options);
}
