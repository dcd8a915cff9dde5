/*
 * Ceres as a peer: Levenberg-Marquardt with its own scaling of the parameters, dense QR, bounds on the parameters, the
 * analytic Jacobian. The problem is built once a material.
 *
 * Ceres projects its steps into the box and stalls, short of 1e-6 in E^2, where coefficients are zero at the optimum,
 * whatever its tolerances. In the logarithmic chart, its best, coefficients that ended on zero are therefore held there
 * and Ceres goes on with the rest, then once more with all of them free, until that no longer helps.
 * SPDX-License-Identifier: MIT
 */
#include <ceres/ceres.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <new>
#include <vector>

#include "peers_solver.h"

namespace {

class Residuals : public ceres::CostFunction {
public:
    explicit Residuals(const peers_problem *problem) : problem_(problem)
    {
        set_num_residuals(static_cast<int>(peers_residuals(problem)));
        mutable_parameter_block_sizes()->push_back(static_cast<int>(peers_parameters(problem)));
    }

    bool Evaluate(double const *const *parameter, double *residual, double **jacobian) const override
    {
        const size_t count = peers_residuals(problem_);

        peers_model(problem_, parameter[0], residual);
        for (size_t j = 0; j < count; j++) {
            residual[j] -= problem_->value[j];
            if (!std::isfinite(residual[j])) {
                return false; /* the step is rejected */
            }
        }
        if (jacobian && jacobian[0]) {
            peers_jacobian(problem_, parameter[0], jacobian[0]);
        }
        return true;
    }

private:
    const peers_problem *problem_;
};

struct Run {
    ceres::Problem problem;
    ceres::Solver::Options options;
    double parameter[PEERS_MOST_PARAMETERS];
    int count, lobes;
    bool release; /* hold and release coefficients on zero */

    Run() : problem(options_of_problem()) {}

    static ceres::Problem::Options options_of_problem()
    {
        ceres::Problem::Options o;

        o.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
        return o;
    }
};

void *create(const peers_problem *p)
{
    double lower[PEERS_MOST_PARAMETERS], upper[PEERS_MOST_PARAMETERS];
    Run *run = new (std::nothrow) Run;

    if (!run) {
        return nullptr;
    }
    FLAGS_minloglevel = google::GLOG_FATAL; /* a start that cannot be evaluated is counted, not narrated */
    run->count = static_cast<int>(peers_parameters(p));
    run->lobes = p->lobes;
    run->release = p->chart == PEERS_LOG;
    run->problem.AddResidualBlock(new Residuals(p), nullptr, run->parameter);
    peers_bounds(p, lower, upper);
    for (int j = 0; j < run->count; j++) {
        if (std::isfinite(lower[j])) {
            run->problem.SetParameterLowerBound(run->parameter, j, lower[j]);
        }
        if (std::isfinite(upper[j])) {
            run->problem.SetParameterUpperBound(run->parameter, j, upper[j]);
        }
    }
    run->options.linear_solver_type = ceres::DENSE_QR;
    run->options.max_num_iterations = PEERS_MOST_ITERATIONS;
    run->options.gradient_tolerance = PEERS_GRADIENT;
    run->options.parameter_tolerance = PEERS_STEP;
    run->options.function_tolerance = PEERS_DECREASE;
    run->options.logging_type = ceres::SILENT;
    run->options.num_threads = 1;
    return run;
}

/* From run->parameter, with the coefficients of `held` (may be empty) constant. */
bool solve(Run *run, const std::vector<int> &held, int *iterations, double *cost)
{
    const std::unique_ptr<ceres::Manifold> manifold(
        held.empty() ? nullptr : new ceres::SubsetManifold(run->count, held));
    ceres::Solver::Summary summary;

    run->problem.SetManifold(run->parameter, manifold.get());
    ceres::Solve(run->options, &run->problem, &summary);
    run->problem.SetManifold(run->parameter, nullptr);
    *iterations += static_cast<int>(summary.iterations.size());
    *cost = summary.final_cost;
    return summary.IsSolutionUsable();
}

std::vector<int> on_zero(const Run *run)
{
    std::vector<int> held;

    for (int j = run->lobes; j < run->count; j++) {
        if (!(run->parameter[j] > 1e-9)) {
            held.push_back(j);
        }
    }
    return held;
}

int run_ceres(void *solver, double *parameter)
{
    Run *run = static_cast<Run *>(solver);
    double cost, before;
    int iterations = 0;

    std::copy(parameter, parameter + run->count, run->parameter);
    bool good = solve(run, {}, &iterations, &cost);
    for (int round = 0; round < 5 && good && run->release; round++) {
        const std::vector<int> held = on_zero(run);

        before = cost;
        if (held.empty()) {
            break;
        }
        good = solve(run, held, &iterations, &cost) && solve(run, {}, &iterations, &cost);
        if (!(cost < before * (1.0 - 1e-9))) {
            break;
        }
    }
    std::copy(run->parameter, run->parameter + run->count, parameter);
    return good ? iterations : -1;
}

void destroy(void *solver)
{
    delete static_cast<Run *>(solver);
}

} // namespace

const peers_solver peers_ceres = {"ceres", CERES_VERSION_STRING, create, run_ceres, destroy};
