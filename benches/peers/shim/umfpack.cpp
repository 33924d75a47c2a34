#include "peer.h"

#include <umfpack.h>
#include <vector>

namespace {

class Umfpack final : public Peer {
public:
    Umfpack(const Matrix& matrix, const double* options) : a(matrix) {
        a.is_complex ? umfpack_zi_defaults(control) : umfpack_di_defaults(control);
        control[UMFPACK_STRATEGY] = options[0];
        control[UMFPACK_ORDERING] = options[1];
        control[UMFPACK_IRSTEP] = options[2];
    }

    ~Umfpack() override {
        a.is_complex ? umfpack_zi_free_numeric(&numeric) : umfpack_di_free_numeric(&numeric);
        a.is_complex ? umfpack_zi_free_symbolic(&symbolic) : umfpack_di_free_symbolic(&symbolic);
    }

    // Null pointers for imaginary parts mean that complex numbers are stored as pairs.
    int analyse() override {
        return a.is_complex ? umfpack_zi_symbolic(a.size, a.size, a.starts, a.rows, a.values, nullptr, &symbolic,
                                                  control, nullptr)
                            : umfpack_di_symbolic(a.size, a.size, a.starts, a.rows, a.values, &symbolic, control,
                                                  nullptr);
    }

    int factor() override {
        // Sizes as umfpack_wsolve.h asks for with refinement, so that a solve allocates nothing.
        integers.resize(a.size);
        numbers.resize(static_cast<size_t>(a.is_complex ? 10 : 5) * a.size);
        return a.is_complex
                   ? umfpack_zi_numeric(a.starts, a.rows, a.values, nullptr, symbolic, &numeric, control, nullptr)
                   : umfpack_di_numeric(a.starts, a.rows, a.values, symbolic, &numeric, control, nullptr);
    }

    int solve(const double* b, double* x) override {
        return a.is_complex ? umfpack_zi_wsolve(UMFPACK_A, a.starts, a.rows, a.values, nullptr, x, nullptr, b,
                                                nullptr, numeric, control, nullptr, integers.data(), numbers.data())
                            : umfpack_di_wsolve(UMFPACK_A, a.starts, a.rows, a.values, x, b, numeric, control,
                                                nullptr, integers.data(), numbers.data());
    }

private:
    Matrix a;
    double control[UMFPACK_CONTROL];
    void* symbolic = nullptr;
    void* numeric = nullptr;
    std::vector<int> integers;
    std::vector<double> numbers;
};

} // namespace

Peer* new_umfpack(const Matrix& a, const double* options) { return new Umfpack(a, options); }
