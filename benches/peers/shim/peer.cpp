// The C interface. No exception leaves it: running out of memory is status -1.
#include "peer.h"

#include <Eigen/Core>
#include <ctime>
#include <exception>
#include <klu.h>
#include <umfpack.h>

#define TEXT(x) #x
#define DOTTED(a, b, c) TEXT(a) "." TEXT(b) "." TEXT(c)

namespace {

template <class Step> int status_of(Step step) {
    try {
        return step();
    } catch (const std::exception&) {
        return -1;
    }
}

} // namespace

extern "C" {

Peer* peer_new(const Matrix* a, int library, const double* options) {
    using Maker = Peer* (*)(const Matrix&, const double*);
    const Maker makers[] = {new_umfpack, new_klu, new_sparse_lu, new_ldlt};
    try {
        return makers[library](*a, options);
    } catch (const std::exception&) {
        return nullptr;
    }
}

int peer_analyse(Peer* peer) {
    return status_of([=] { return peer->analyse(); });
}

int peer_factor(Peer* peer) {
    return status_of([=] { return peer->factor(); });
}

int peer_solve(Peer* peer, const double* b, double* x) {
    return status_of([=] { return peer->solve(b, x); });
}

void peer_free(Peer* peer) { delete peer; }

double peer_cpu_seconds() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

const char* peer_versions() {
    return "UMFPACK " DOTTED(UMFPACK_MAIN_VERSION, UMFPACK_SUB_VERSION, UMFPACK_SUBSUB_VERSION)
           ", KLU " DOTTED(KLU_MAIN_VERSION, KLU_SUB_VERSION, KLU_SUBSUB_VERSION)
           ", Eigen " DOTTED(EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION);
}
}
