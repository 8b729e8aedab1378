// Includes doctest with its main(), and names each test that passed, which doctest leaves out: PlatformIO
// counts the tests it reads. Include it in exactly one file of a suite.
#pragma once

#define DOCTEST_CONFIG_IMPLEMENT_WITH_MAIN
#include <doctest/doctest.h>

#include <iostream>

namespace tilenca {
namespace test {

struct PassedTests : doctest::IReporter {
    explicit PassedTests(const doctest::ContextOptions&) {}

    void test_case_start(const doctest::TestCaseData& test) override { test_ = &test; }

    void test_case_end(const doctest::CurrentTestCaseStats& stats) override {
        if (stats.failure_flags == doctest::TestCaseFailureReason::None) {
            std::cout << std::string(79, '=') << '\n'
                      << test_->m_file.c_str() << ':' << test_->m_line << ":\nTEST CASE:  " << test_->m_name
                      << "\n\n";
        }
    }

    void report_query(const doctest::QueryData&) override {}
    void test_run_start() override {}
    void test_run_end(const doctest::TestRunStats&) override {}
    void test_case_reenter(const doctest::TestCaseData&) override {}
    void test_case_exception(const doctest::TestCaseException&) override {}
    void subcase_start(const doctest::SubcaseSignature&) override {}
    void subcase_end() override {}
    void log_assert(const doctest::AssertData&) override {}
    void log_message(const doctest::MessageData&) override {}
    void test_case_skipped(const doctest::TestCaseData&) override {}

  private:
    const doctest::TestCaseData* test_ = nullptr;
};

REGISTER_LISTENER("passed", 1, PassedTests);

} // namespace test
} // namespace tilenca
