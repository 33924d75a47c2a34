// Matrices and vectors of ours as Eigen sees them.
#pragma once

#include "peer.h"

#include <Eigen/Sparse>
#include <complex>

template <class T> using Sparse = Eigen::SparseMatrix<T, Eigen::ColMajor, int>;
template <class T> using Vector = Eigen::Matrix<T, Eigen::Dynamic, 1>;

// std::complex<double> is laid out as a pair of doubles.
template <class T> Sparse<T> copy_of(const Matrix& a) {
    auto values = reinterpret_cast<const T*>(a.values);
    return Eigen::Map<const Sparse<T>>(a.size, a.size, a.starts[a.size], a.starts, a.rows, values);
}

template <class T> Eigen::Map<const Vector<T>> view(const double* x, int size) {
    return {reinterpret_cast<const T*>(x), size};
}

template <class T> Eigen::Map<Vector<T>> view(double* x, int size) { return {reinterpret_cast<T*>(x), size}; }
