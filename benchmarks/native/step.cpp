// One step of the Material Point Method as plain loops: the yardstick of `matpoint bench`.
//
//   c++ -O3 -march=native -ffast-math -std=c++17 step.cpp -o step
//   ./step CELLS STEPS ROUNDS [DUMP]
//
// Three dimensions, quadratic B-splines, FLIP, update stress last, neo-Hookean, gravity: the step that
// matpoint makes with BSpline(2), on the block of src/matpoint/bench/block.py. One thread. No intrinsics and
// no libraries, only what a careful author writes and leaves to the compiler: one array for each field of the
// particles, which are in order of cell; one record for all that a node holds; loops of fixed length; the
// stress in the loop that has L in registers. Of six plain variants this one was the fastest: with an array for
// each component the step takes 1.4 times as long, with scalar sums in the place of the loops over a record 1.2
// times (gcc 12, AVX-512).
//
// Prints one JSON object: particles, steps, seconds of each round and of each stage, and sums over the
// particles, so that nothing can be left out as unused. DUMP receives x, v (6 float64 a particle) by lattice
// index.

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

namespace {

constexpr double modulus = 1e6, poisson = 0.3, density = 1000.0, gravity = 9.8, speed = 1.0, waves = 0.05;
constexpr double shear = modulus / (2 * (1 + poisson));
constexpr double lame = modulus * poisson / ((1 + poisson) * (1 - 2 * poisson));
constexpr int margin = 4;         // empty cells below the block; one more lies above
constexpr double offset = 0.16;   // of a cell: the block is not on the grid's lattice
constexpr int per_cell = 2;
constexpr double courant = 0.1;   // dt = courant h / c
constexpr double wave = 40.0;     // c [m/s], rounded up

using Array = std::vector<double>;

double now() {
    using namespace std::chrono;
    return duration<double>(steady_clock::now().time_since_epoch()).count();
}

struct Particles {
    int count = 0;
    double mass = 0, volume0 = 0;  // the same for all
    Array x, v, F, stress, volume;
    std::vector<int> lattice;
};

// Before the solve momentum, mass, force; after it velocity, mass, increment.
struct alignas(64) Node {
    double value[8];
};

struct Grid {
    double h, lower;
    int n;  // nodes along each axis
    std::vector<Node> nodes;
};

// The three splines that reach a point, and their derivatives.
struct Row {
    int first;
    double w[3], d[3];
};

inline Row row(double x, double lower, double inverse) {
    const double r = (x - lower) * inverse;
    const int cell = static_cast<int>(r);
    const double f = r - cell, g = 1.0 - f;
    return {cell, {0.5 * g * g, 0.5 + f * g, 0.5 * f * f}, {-g * inverse, (g - f) * inverse, f * inverse}};
}

void particles_to_nodes(const Particles& p, Grid& grid) {
    const double inverse = 1.0 / grid.h, m = p.mass;
    for (int q = 0; q < p.count; ++q) {
        const double* x = &p.x[3 * q];
        const Row a = row(x[0], grid.lower, inverse), b = row(x[1], grid.lower, inverse),
                  c = row(x[2], grid.lower, inverse);
        const double *v = &p.v[3 * q], *t = &p.stress[6 * q], V = -p.volume[q];
        const double xx = V * t[0], yy = V * t[1], zz = V * t[2], xy = V * t[3], yz = V * t[4], xz = V * t[5];
        const double content[8] = {m * v[0], m * v[1], m * v[2], m, 0, -m * gravity, 0, 0};
        const double pull_x[8] = {0, 0, 0, 0, xx, xy, xz, 0};
        const double pull_y[8] = {0, 0, 0, 0, xy, yy, yz, 0};
        const double pull_z[8] = {0, 0, 0, 0, xz, yz, zz, 0};
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) {
                const double ww = a.w[i] * b.w[j], dw = a.d[i] * b.w[j], wd = a.w[i] * b.d[j];
                double line[8], slope[8];
                for (int s = 0; s < 8; ++s) {
                    line[s] = ww * content[s] + dw * pull_x[s] + wd * pull_y[s];
                    slope[s] = ww * pull_z[s];
                }
                Node* node = &grid.nodes[((a.first + i) * grid.n + b.first + j) * grid.n + c.first];
                for (int k = 0; k < 3; ++k)
                    for (int s = 0; s < 8; ++s) node[k].value[s] += c.w[k] * line[s] + c.d[k] * slope[s];
            }
        }
    }
}

void solve(Grid& grid, double dt) {
    for (Node& node : grid.nodes) {
        if (node.value[3] <= 0.0) continue;
        const double inverse = 1.0 / node.value[3];
        for (int s = 0; s < 3; ++s) {
            const double increment = node.value[4 + s] * inverse * dt;
            node.value[s] = node.value[s] * inverse + increment;
            node.value[4 + s] = increment;
        }
    }
}

// F = (I + L dt) F, then the Cauchy stress of the neo-Hookean law.
inline void update_stress(Particles& p, int q, const double L[9], double dt) {
    double F[9], b[6];
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            double sum = p.F[9 * q + 3 * i + j];
            for (int k = 0; k < 3; ++k) sum += dt * L[3 * i + k] * p.F[9 * q + 3 * k + j];
            F[3 * i + j] = sum;
        }
    for (int i = 0; i < 9; ++i) p.F[9 * q + i] = F[i];
    const double J = F[0] * (F[4] * F[8] - F[5] * F[7]) - F[1] * (F[3] * F[8] - F[5] * F[6]) +
                     F[2] * (F[3] * F[7] - F[4] * F[6]);
    b[0] = F[0] * F[0] + F[1] * F[1] + F[2] * F[2];
    b[1] = F[3] * F[3] + F[4] * F[4] + F[5] * F[5];
    b[2] = F[6] * F[6] + F[7] * F[7] + F[8] * F[8];
    b[3] = F[0] * F[3] + F[1] * F[4] + F[2] * F[5];
    b[4] = F[3] * F[6] + F[4] * F[7] + F[5] * F[8];
    b[5] = F[0] * F[6] + F[1] * F[7] + F[2] * F[8];
    const double mu = shear / J, mean = lame * std::log(J) / J - mu;
    for (int i = 0; i < 3; ++i) p.stress[6 * q + i] = mean + mu * b[i];
    for (int i = 3; i < 6; ++i) p.stress[6 * q + i] = mu * b[i];
    p.volume[q] = J * p.volume0;
}

void nodes_to_particles(Particles& p, const Grid& grid, double dt) {
    const double inverse = 1.0 / grid.h;
    for (int q = 0; q < p.count; ++q) {
        const double* x = &p.x[3 * q];
        const Row a = row(x[0], grid.lower, inverse), b = row(x[1], grid.lower, inverse),
                  c = row(x[2], grid.lower, inverse);
        double value[8] = {}, along_x[8] = {}, along_y[8] = {}, along_z[8] = {};
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) {
                const Node* node = &grid.nodes[((a.first + i) * grid.n + b.first + j) * grid.n + c.first];
                const double ww = a.w[i] * b.w[j], dw = a.d[i] * b.w[j], wd = a.w[i] * b.d[j];
                for (int s = 0; s < 8; ++s) {
                    const double n0 = node[0].value[s], n1 = node[1].value[s], n2 = node[2].value[s];
                    const double line = c.w[0] * n0 + c.w[1] * n1 + c.w[2] * n2;
                    value[s] += ww * line;
                    along_x[s] += dw * line;
                    along_y[s] += wd * line;
                    along_z[s] += ww * (c.d[0] * n0 + c.d[1] * n1 + c.d[2] * n2);
                }
            }
        }
        double L[9];
        for (int s = 0; s < 3; ++s) {
            p.v[3 * q + s] += value[4 + s];
            p.x[3 * q + s] += dt * value[s];
            L[3 * s] = along_x[s], L[3 * s + 1] = along_y[s], L[3 * s + 2] = along_z[s];
        }
        update_stress(p, q, L, dt);
    }
}

Particles block(int cells, const Grid& grid) {
    Particles p;
    const int side = per_cell * cells;
    const double spacing = 1.0 / side;
    p.count = side * side * side;
    p.volume0 = spacing * spacing * spacing;
    p.mass = density * p.volume0;
    // A counting sort by cell, the last axis fastest; lattice order inside a cell.
    std::vector<int> start(static_cast<size_t>(grid.n) * grid.n * grid.n + 1, 0), cell(p.count);
    auto place = [&](int i) { return static_cast<int>(((i + 0.5) * spacing - grid.lower) / grid.h); };
    for (int q = 0; q < p.count; ++q) {
        const int i = q / (side * side), j = q / side % side, k = q % side;
        cell[q] = (place(i) * grid.n + place(j)) * grid.n + place(k);
        ++start[cell[q] + 1];
    }
    for (size_t s = 1; s < start.size(); ++s) start[s] += start[s - 1];
    p.lattice.resize(p.count);
    for (int q = 0; q < p.count; ++q) p.lattice[start[cell[q]]++] = q;
    const auto count = static_cast<size_t>(p.count);
    p.x.resize(3 * count);
    p.v.resize(3 * count);
    p.stress.assign(6 * count, 0.0);
    p.F.assign(9 * count, 0.0);
    for (size_t i = 0; i < p.F.size(); ++i) p.F[i] = i % 9 % 4 == 0 ? 1.0 : 0.0;
    p.volume.assign(p.count, p.volume0);
    for (int q = 0; q < p.count; ++q) {
        const int at = p.lattice[q], index[3] = {at / (side * side), at / side % side, at % side};
        for (int s = 0; s < 3; ++s) p.x[3 * q + s] = (index[s] + 0.5) * spacing;
        const double* x = &p.x[3 * q];
        for (int s = 0; s < 3; ++s) p.v[3 * q + s] = speed * (1 + waves * std::sin(3.0 * x[(s + 1) % 3]));
    }
    return p;
}

double sum(const Array& a) {
    double total = 0;
    for (double value : a) total += value;
    return total;
}

void dump(const Particles& p, const char* path) {
    Array out(6 * static_cast<size_t>(p.count));
    for (int q = 0; q < p.count; ++q)
        for (int s = 0; s < 3; ++s) {
            double* at = &out[6 * static_cast<size_t>(p.lattice[q]) + s];
            at[0] = p.x[3 * q + s], at[3] = p.v[3 * q + s];
        }
    FILE* file = std::fopen(path, "wb");
    if (!file || std::fwrite(out.data(), sizeof(double), out.size(), file) != out.size()) std::exit(1);
    std::fclose(file);
}

}  // namespace

int main(int argc, char** argv) {
    const int cells = argc > 1 ? std::atoi(argv[1]) : 29;
    const int steps = argc > 2 ? std::atoi(argv[2]) : 10;
    const int rounds = argc > 3 ? std::atoi(argv[3]) : 5;
    if (cells < 1 || steps < 1 || rounds < 1) {
        std::fprintf(stderr, "usage: step CELLS STEPS ROUNDS [DUMP]\n");
        return 2;
    }
    Grid grid{1.0 / cells, -(margin + offset) / cells, cells + 2 * margin + 3, {}};
    grid.nodes.resize(static_cast<size_t>(grid.n) * grid.n * grid.n);
    Particles p = block(cells, grid);
    const double dt = courant * grid.h / wave;
    double stage[4] = {};
    Array seconds;
    for (int r = 0; r < rounds; ++r) {
        const double begin = now();
        for (int s = 0; s < steps; ++s) {
            double t[5] = {now()};
            for (Node& node : grid.nodes) node = Node{};
            t[1] = now();
            particles_to_nodes(p, grid);
            t[2] = now();
            solve(grid, dt);
            t[3] = now();
            nodes_to_particles(p, grid, dt);
            t[4] = now();
            for (int k = 0; k < 4; ++k) stage[k] += t[k + 1] - t[k];
        }
        seconds.push_back(now() - begin);
    }
    std::printf("{\"particles\": %d, \"steps\": %d, \"seconds\": [", p.count, steps);
    for (int r = 0; r < rounds; ++r) std::printf("%s%.9g", r ? ", " : "", seconds[r]);
    std::printf("], \"stages\": {\"clear\": %.9g, \"particles to nodes\": %.9g, \"solve\": %.9g,"
                " \"nodes to particles\": %.9g}", stage[0], stage[1], stage[2], stage[3]);
    std::printf(", \"sum\": {\"x\": %.17g, \"v\": %.17g, \"volume\": %.17g}}\n", sum(p.x), sum(p.v), sum(p.volume));
    if (argc > 4) dump(p, argv[4]);
    return 0;
}
