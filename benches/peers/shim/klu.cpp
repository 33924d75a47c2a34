#include "peer.h"

#include <algorithm>
#include <klu.h>

namespace {

class Klu final : public Peer {
public:
    Klu(const Matrix& matrix, const double* options) : a(matrix) {
        klu_defaults(&common);
        common.ordering = static_cast<int>(options[0]);
        common.btf = static_cast<int>(options[1]);
    }

    ~Klu() override {
        a.is_complex ? klu_z_free_numeric(&numeric, &common) : klu_free_numeric(&numeric, &common);
        klu_free_symbolic(&symbolic, &common);
    }

    int analyse() override {
        symbolic = klu_analyze(a.size, starts(), rows(), &common);
        return common.status;
    }

    int factor() override {
        auto values = const_cast<double*>(a.values);
        numeric = a.is_complex ? klu_z_factor(starts(), rows(), values, symbolic, &common)
                               : klu_factor(starts(), rows(), values, symbolic, &common);
        return common.status;
    }

    int solve(const double* b, double* x) override {
        std::copy_n(b, static_cast<size_t>(a.is_complex ? 2 : 1) * a.size, x);
        a.is_complex ? klu_z_solve(symbolic, numeric, a.size, 1, x, &common)
                     : klu_solve(symbolic, numeric, a.size, 1, x, &common);
        return common.status;
    }

private:
    // KLU takes its input as not const, and leaves it as it is.
    int* starts() { return const_cast<int*>(a.starts); }
    int* rows() { return const_cast<int*>(a.rows); }

    Matrix a;
    klu_common common;
    klu_symbolic* symbolic = nullptr;
    klu_numeric* numeric = nullptr;
};

} // namespace

Peer* new_klu(const Matrix& a, const double* options) { return new Klu(a, options); }
