/*
 * Files, pipes and standard input. gzip: test_io_gzip.c. SPDX-License-Identifier: MIT
 */
#define _POSIX_C_SOURCE 200809L
#include <errno.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "io/bytes/source.h"
#include "io_support.h"

static const char text[] = "theta_i,theta_o,r\n0,0,1\n30,60,2\n";

static char directory[64];
static char path[128];

static int make_directory(void **state)
{
    (void)state;
    strcpy(directory, "/tmp/brdffit_files_XXXXXX");
    return mkdtemp(directory) ? 0 : -1;
}

static int remove_directory(void **state)
{
    (void)state;
    return rmdir(directory);
}

/* Write a file of the temporary directory; its path is left in `path`. */
static void put(const char *name, const void *data, size_t size)
{
    FILE *file;

    (void)snprintf(path, sizeof path, "%s/%s", directory, name);
    file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(data, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

static void refuse(const char *name, brdffit_status expected, const char *message)
{
    brdffit_table *table = (brdffit_table *)&table;
    brdffit_error error;
    brdffit_status status;

    errno = 12345;
    status = brdffit_io_read(name, NULL, &table, &error);
    io_assert_failed(status, table, &error, expected, message);
    assert_int_equal(errno, 12345); /* the message says it all */
    assert_int_equal(error.line, BRDFFIT_NONE);
    assert_int_equal(error.sample, BRDFFIT_NONE);
}

static void test_text_file(void **state)
{
    brdffit_table *table;
    brdffit_error error;

    (void)state;
    put("anything.binary", text, sizeof text - 1); /* the name says nothing */
    assert_int_equal(brdffit_io_read(path, NULL, &table, &error), BRDFFIT_OK);
    assert_int_equal(table->format, BRDFFIT_IO_FORMAT_CSV);
    assert_int_equal(table->samples->count, 2);
    assert_int_equal(table->compressed, 0);
    brdffit_io_free(table);
    assert_int_equal(unlink(path), 0);
}

static void test_merl_file(void **state)
{
    struct io_merl merl = io_merl_new(4, 3, 6);
    brdffit_table *table;
    brdffit_error error;

    (void)state;
    put("table.csv", merl.data, merl.size);
    assert_int_equal(brdffit_io_read(path, NULL, &table, &error), BRDFFIT_OK);
    assert_int_equal(table->format, BRDFFIT_IO_FORMAT_MERL);
    assert_int_equal(table->rows, 72);
    brdffit_io_free(table);
    assert_int_equal(truncate(path, (off_t)merl.size - 8), 0);
    assert_int_equal(brdffit_io_read(path, NULL, &table, &error), BRDFFIT_ERR_FORMAT);
    assert_non_null(strstr(error.message, "shorter than its header says"));
    assert_same(error.value, (double)merl.size);
    assert_int_equal(unlink(path), 0);
    free(merl.data);
}

static void test_missing(void **state)
{
    char deep[200];

    (void)state;
    (void)snprintf(path, sizeof path, "%s/nothing", directory);
    refuse(path, BRDFFIT_ERR_OPEN, "no such file");
    refuse("", BRDFFIT_ERR_OPEN, "no such file");
    assert_int_equal(symlink("nowhere", path), 0); /* dangling */
    refuse(path, BRDFFIT_ERR_OPEN, "no such file");
    assert_int_equal(unlink(path), 0);
    put("file", text, 1);
    (void)snprintf(deep, sizeof deep, "%s/below", path);
    refuse(deep, BRDFFIT_ERR_OPEN, "not a directory");
    assert_int_equal(unlink(path), 0);
    assert_int_equal(symlink(path, path), 0);
    refuse(path, BRDFFIT_ERR_OPEN, "symbolic links");
    assert_int_equal(unlink(path), 0);
}

static void test_long_name(void **state)
{
    char *name = malloc(100001);

    (void)state;
    assert_non_null(name);
    memset(name, 'a', 100000);
    name[100000] = '\0';
    refuse(name, BRDFFIT_ERR_OPEN, "name is too long");
    free(name);
}

static void test_directory(void **state)
{
    (void)state;
    refuse(directory, BRDFFIT_ERR_OPEN, "is a directory");
}

/* Root may read everything, so it becomes nobody for this one. */
static void test_unreadable(void **state)
{
    int root = geteuid() == 0;

    (void)state;
    put("secret", text, sizeof text - 1);
    assert_int_equal(chmod(path, 0), 0);
    if (root && (chmod(directory, 0755) != 0 || seteuid(65534) != 0)) {
        assert_int_equal(unlink(path), 0);
        skip();
    }
    refuse(path, BRDFFIT_ERR_OPEN, "no permission");
    if (root) {
        assert_int_equal(seteuid(0), 0);
    }
    assert_int_equal(unlink(path), 0);
}

static void test_empty(void **state)
{
    (void)state;
    put("empty", text, 0);
    refuse(path, BRDFFIT_ERR_FORMAT, "empty");
    assert_int_equal(unlink(path), 0);
    refuse("/dev/null", BRDFFIT_ERR_FORMAT, "empty");
}

/* A system's refusal that no message names leaves its errno for the caller to translate. */
static void test_other_errors(void **state)
{
    brdffit_table *table;
    brdffit_error error;
    int input = dup(STDIN_FILENO), writer;

    (void)state;
    put("writer", text, 1);
    writer = open(path, O_WRONLY);
    assert_true(input >= 0 && writer >= 0);
    assert_true(dup2(writer, STDIN_FILENO) == STDIN_FILENO);
    errno = 0;
    assert_int_equal(brdffit_io_read("-", NULL, &table, &error), BRDFFIT_ERR_READ);
    assert_int_equal(errno, EBADF);
    assert_string_equal(error.message, "reading the file failed");
    assert_null(table);
    assert_true(dup2(input, STDIN_FILENO) == STDIN_FILENO);
    close(input);
    close(writer);
    assert_int_equal(unlink(path), 0);
}

/* Let a child write `size` bytes in odd pieces into a pipe that becomes standard input; read "-". */
static brdffit_status read_pipe(const unsigned char *data, size_t size, brdffit_table **table, brdffit_error *error)
{
    int ends[2], input = dup(STDIN_FILENO), told;
    brdffit_status status;
    pid_t child;

    assert_true(input >= 0 && pipe(ends) == 0);
    child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        size_t at = 0, piece = 1;

        close(ends[0]);
        while (at < size) {
            size_t want = piece < size - at ? piece : size - at;
            ssize_t put_bytes = write(ends[1], data + at, want);

            if (put_bytes < 0) {
                _exit(1);
            }
            at += (size_t)put_bytes;
            piece = piece % 70000 + 999;
        }
        _exit(0);
    }
    close(ends[1]);
    assert_true(dup2(ends[0], STDIN_FILENO) == STDIN_FILENO);
    close(ends[0]);
    status = brdffit_io_read("-", NULL, table, error);
    assert_true(dup2(input, STDIN_FILENO) == STDIN_FILENO);
    close(input);
    assert_int_equal(waitpid(child, &told, 0), child);
    assert_int_equal(told, 0);
    return status;
}

static void test_standard_input(void **state)
{
    struct io_merl merl = io_merl_new(30, 30, 40);
    brdffit_table *table, *same;
    brdffit_error error;
    unsigned char *packed;
    size_t size;

    (void)state;
    assert_int_equal(read_pipe((const unsigned char *)text, sizeof text - 1, &table, &error), BRDFFIT_OK);
    assert_int_equal(table->samples->count, 2);
    brdffit_io_free(table);
    assert_int_equal(read_pipe(merl.data, merl.size, &table, &error), BRDFFIT_OK);
    assert_int_equal(table->rows, 36000);
    packed = io_gzip(merl.data, merl.size, &size);
    assert_int_equal(read_pipe(packed, size, &same, &error), BRDFFIT_OK);
    assert_int_equal(same->compressed, 1);
    assert_int_equal(same->samples->count, table->samples->count);
    assert_memory_equal(same->samples->values, table->samples->values, 24 * table->samples->count);
    brdffit_io_free(table);
    brdffit_io_free(same);
    assert_int_equal(read_pipe(merl.data, 0, &table, &error), BRDFFIT_ERR_FORMAT);
    assert_string_equal(error.message, "the file is empty");
    free(packed);
    free(merl.data);
}

static void test_named_pipe(void **state)
{
    brdffit_table *table;
    brdffit_error error;
    pid_t child;
    int told;

    (void)state;
    (void)snprintf(path, sizeof path, "%s/pipe", directory);
    assert_int_equal(mkfifo(path, 0600), 0);
    child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        int end = open(path, O_WRONLY);

        _exit(write(end, text, sizeof text - 1) == (ssize_t)sizeof text - 1 ? 0 : 1);
    }
    assert_int_equal(brdffit_io_read(path, NULL, &table, &error), BRDFFIT_OK);
    assert_int_equal(table->samples->count, 2);
    brdffit_io_free(table);
    assert_int_equal(waitpid(child, &told, 0), child);
    assert_int_equal(told, 0);
    assert_int_equal(unlink(path), 0);
}

/* The limit, with a small one in place of 8 GiB: a file by its size, a pipe by what comes out of it. */
static void test_limit(void **state)
{
    struct io_bytes bytes = {NULL, 0, 0};
    brdffit_error error;
    size_t size = sizeof text - 1;

    (void)state;
    put("some", text, size);
    assert_int_equal(brdffit_io_source_read(path, size, &bytes, &error), BRDFFIT_OK);
    assert_int_equal(bytes.size, size);
    brdffit_io_bytes_free(&bytes);
    assert_int_equal(brdffit_io_source_read(path, size - 1, &bytes, &error), BRDFFIT_ERR_FORMAT);
    assert_non_null(strstr(error.message, "larger than the limit"));
    assert_same(error.value, (double)(size - 1));
    assert_int_equal(bytes.capacity, 0);
    assert_int_equal(brdffit_io_source_read("/dev/zero", 300000, &bytes, &error), BRDFFIT_ERR_FORMAT);
    assert_non_null(strstr(error.message, "larger than the limit"));
    assert_in_range(bytes.capacity, 300001, 300001);
    brdffit_io_bytes_free(&bytes);
    assert_int_equal(truncate(path, (off_t)9 << 30), 0); /* sparse: no disk is used, and no memory must be */
    refuse(path, BRDFFIT_ERR_FORMAT, "larger than the limit");
    assert_int_equal(unlink(path), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_text_file),  cmocka_unit_test(test_merl_file),    cmocka_unit_test(test_missing),
        cmocka_unit_test(test_long_name),  cmocka_unit_test(test_directory),    cmocka_unit_test(test_unreadable),
        cmocka_unit_test(test_empty),      cmocka_unit_test(test_other_errors), cmocka_unit_test(test_standard_input),
        cmocka_unit_test(test_named_pipe), cmocka_unit_test(test_limit),
    };

    return cmocka_run_group_tests(tests, make_directory, remove_directory);
}
