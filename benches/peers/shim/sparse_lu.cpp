#include "eigen.h"

#include <Eigen/SparseLU>

namespace {

template <class T, class Ordering> class SparseLu final : public Peer {
public:
    SparseLu(const Matrix& matrix, const double* options) : a(copy_of<T>(matrix)) {
        lu.isSymmetric(options[1] != 0.0);
        lu.setPivotThreshold(options[2]);
    }

    int analyse() override {
        lu.analyzePattern(a);
        return 0;
    }

    int factor() override {
        lu.factorize(a);
        return lu.info();
    }

    int solve(const double* b, double* x) override {
        auto size = static_cast<int>(a.rows());
        view<T>(x, size) = lu.solve(view<T>(b, size));
        return lu.info();
    }

private:
    Sparse<T> a;
    Eigen::SparseLU<Sparse<T>, Ordering> lu;
};

template <class T> Peer* with_ordering(const Matrix& a, const double* options) {
    if (options[0] == 0.0) {
        return new SparseLu<T, Eigen::COLAMDOrdering<int>>(a, options);
    }
    return new SparseLu<T, Eigen::AMDOrdering<int>>(a, options);
}

} // namespace

Peer* new_sparse_lu(const Matrix& a, const double* options) {
    return a.is_complex ? with_ordering<std::complex<double>>(a, options) : with_ordering<double>(a, options);
}
