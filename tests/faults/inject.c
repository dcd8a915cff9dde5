/*
 * A system that fails: run a program, and let one of its system calls go wrong. SPDX-License-Identifier: MIT
 *
 *     inject KIND count FILE -- PROGRAM ...           write to FILE how many calls of the kind there were
 *     inject KIND error NAME K [on] -- PROGRAM ...    call K fails (ENOSPC, EIO, ...), and with `on` all later ones
 *     inject KIND kill K -- PROGRAM ...               kill -9 before call K
 *     inject KIND truncate FILE SIZE K -- PROGRAM ... cut FILE to SIZE bytes before call K
 *
 * KIND is write (whatever changes a file or a folder, but for standard error), read (also what maps a file) or touch
 * (both). Calls count from 1, and from main() on: from the first fcntl(2), with which the program looks at its standard
 * descriptors. Threads are followed. The exit status is the program's; 128 + N when signal N ended it; 77 where the system
 * does not let us trace, or this processor is not known here.
 */
#define _GNU_SOURCE
#include <errno.h>
#include <elf.h>
#include <fcntl.h>
#include <signal.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <sys/user.h>
#include <sys/wait.h>
#include <unistd.h>

#define EXIT_UNABLE 77
#define THREADS_MOST 64

enum action { COUNT, FAIL, KILL, CUT };

struct job {
    int writes, reads; /* which calls count */
    enum action action;
    const char *file;  /* of COUNT and CUT */
    off_t size;
    int error, on;
    long at, seen;
    int begun;         /* main() has */
};

/* A thread between a call's entry, where it was made void, and its exit, where it gets its error. */
struct thread {
    pid_t id;
    int inside, failing;
};

static struct thread threads[THREADS_MOST];

static struct thread *thread_of(pid_t id)
{
    size_t i, room = THREADS_MOST;

    for (i = 0; i < THREADS_MOST; i++) {
        if (threads[i].id == id) {
            return &threads[i];
        }
        room = threads[i].id == 0 && room == THREADS_MOST ? i : room;
    }
    if (room == THREADS_MOST) {
        fprintf(stderr, "inject: too many threads\n");
        exit(EXIT_UNABLE);
    }
    memset(&threads[room], 0, sizeof threads[room]);
    threads[room].id = id;
    return &threads[room];
}

/* ---- Registers: the number of a call that begins, the answer of one that ends -------------------------------- */

#if defined(__x86_64__)
static int make_void(pid_t id)
{
    return ptrace(PTRACE_POKEUSER, id, offsetof(struct user_regs_struct, orig_rax), -1L) == 0;
}

static int answer(pid_t id, long value)
{
    return ptrace(PTRACE_POKEUSER, id, offsetof(struct user_regs_struct, rax), value) == 0;
}
#elif defined(__aarch64__)
static int make_void(pid_t id)
{
    int number = -1;
    struct iovec part = {&number, sizeof number};

    return ptrace(PTRACE_SETREGSET, id, (void *)NT_ARM_SYSTEM_CALL, &part) == 0;
}

static int answer(pid_t id, long value)
{
    struct user_regs_struct registers;
    struct iovec part = {&registers, sizeof registers};

    if (ptrace(PTRACE_GETREGSET, id, (void *)NT_PRSTATUS, &part) != 0) {
        return 0;
    }
    registers.regs[0] = (unsigned long long)value;
    return ptrace(PTRACE_SETREGSET, id, (void *)NT_PRSTATUS, &part) == 0;
}
#else
static int make_void(pid_t id)
{
    (void)id;
    return 0;
}

static int answer(pid_t id, long value)
{
    (void)id;
    (void)value;
    return 0;
}
#endif

/* ---- Which calls count ---------------------------------------------------------------------------------------- */

static int is_write(uint64_t number, const uint64_t *argument)
{
    switch ((long)number) {
    case SYS_write:
    case SYS_pwrite64:
    case SYS_writev: return argument[0] != STDERR_FILENO;
    case SYS_openat: return (argument[2] & (O_CREAT | O_TRUNC)) != 0;
    case SYS_fsync:
    case SYS_fdatasync:
    case SYS_ftruncate:
    case SYS_renameat2:
    case SYS_mkdirat:
    case SYS_unlinkat: return 1;
#ifdef SYS_renameat
    case SYS_renameat: return 1;
#endif
#ifdef SYS_rename
    case SYS_rename:
    case SYS_mkdir: return 1;
#endif
    default: return 0;
    }
}

static int is_read(uint64_t number, const uint64_t *argument)
{
    switch ((long)number) {
    case SYS_read:
    case SYS_pread64:
    case SYS_readv:
    case SYS_getdents64: return 1;
    case SYS_mmap: return (int)argument[4] >= 0;
    case SYS_openat: return (argument[2] & (O_CREAT | O_TRUNC)) == 0;
    default: return 0;
    }
}

/* ---- The run -------------------------------------------------------------------------------------------------- */

static void at_entry(struct job *job, struct thread *thread, const struct __ptrace_syscall_info *call)
{
    const uint64_t number = call->entry.nr;

    job->begun = job->begun || number == SYS_fcntl;
    if (!job->begun ||
        !((job->writes && is_write(number, call->entry.args)) || (job->reads && is_read(number, call->entry.args)))) {
        return;
    }
    job->seen++;
    if (job->action == COUNT || !(job->seen == job->at || (job->on && job->seen > job->at))) {
        return;
    }
    if (job->action == FAIL) {
        thread->failing = make_void(thread->id);
    } else if (job->action == KILL) {
        (void)kill(thread->id, SIGKILL);
    } else if (truncate(job->file, job->size) != 0) {
        fprintf(stderr, "inject: %s: %s\n", job->file, strerror(errno));
    }
}

static void at_stop(struct job *job, pid_t id)
{
    struct __ptrace_syscall_info call;
    struct thread *const thread = thread_of(id);

    memset(&call, 0, sizeof call);
    if (ptrace(PTRACE_GET_SYSCALL_INFO, id, sizeof call, &call) <= 0) {
        return; /* it is gone */
    }
    if (call.op == PTRACE_SYSCALL_INFO_ENTRY) {
        at_entry(job, thread, &call);
    } else if (call.op == PTRACE_SYSCALL_INFO_EXIT && thread->failing) {
        thread->failing = 0;
        (void)answer(id, -(long)job->error);
    }
}

/* Until the first process ends; its status. */
static int follow(struct job *job, pid_t program)
{
    int status;

    for (;;) {
        const pid_t id = waitpid(-1, &status, __WALL);
        int deliver = 0;

        if (id < 0) {
            return EXIT_UNABLE << 8;
        }
        if (WIFEXITED(status) || WIFSIGNALED(status)) {
            if (id == program) {
                return status;
            }
            thread_of(id)->id = 0;
            continue;
        }
        if (WSTOPSIG(status) == (SIGTRAP | 0x80)) {
            at_stop(job, id);
        } else if (status >> 16 == 0 && WSTOPSIG(status) != SIGSTOP && WSTOPSIG(status) != SIGTRAP) {
            deliver = WSTOPSIG(status);
        }
        (void)ptrace(PTRACE_SYSCALL, id, NULL, (void *)(intptr_t)deliver);
    }
}

static int run(struct job *job, char **program)
{
    const long options = PTRACE_O_TRACESYSGOOD | PTRACE_O_TRACECLONE | PTRACE_O_EXITKILL;
    const pid_t child = fork();
    int status;

    if (child == 0) {
        if (ptrace(PTRACE_TRACEME, 0, NULL, NULL) != 0) {
            _exit(EXIT_UNABLE);
        }
        execv(program[0], program);
        _exit(127);
    }
    if (child < 0 || waitpid(child, &status, 0) != child || !WIFSTOPPED(status) ||
        ptrace(PTRACE_SETOPTIONS, child, NULL, (void *)options) != 0) {
        return EXIT_UNABLE << 8;
    }
    (void)ptrace(PTRACE_SYSCALL, child, NULL, NULL);
    return follow(job, child);
}

/* ---- What is asked -------------------------------------------------------------------------------------------- */

static int error_named(const char *name)
{
    static const struct {
        const char *name;
        int number;
    } known[] = {{"ENOSPC", ENOSPC}, {"EIO", EIO},       {"EDQUOT", EDQUOT}, {"EACCES", EACCES},
                 {"EROFS", EROFS},   {"EMFILE", EMFILE}, {"ENOMEM", ENOMEM}};
    size_t i;

    for (i = 0; i < sizeof known / sizeof *known; i++) {
        if (strcmp(known[i].name, name) == 0) {
            return known[i].number;
        }
    }
    return 0;
}

/* 0 when the words make no sense. The program begins behind "--". */
static int understand(int count, char **words, struct job *job, char ***program)
{
    int end = 3;

    for (; end < count && strcmp(words[end], "--") != 0; end++) {
    }
    if (end + 1 >= count) {
        return 0;
    }
    *program = words + end + 1;
    job->writes = strcmp(words[1], "read") != 0;
    job->reads = strcmp(words[1], "write") != 0;
    if (strcmp(words[2], "count") == 0 && end == 4) {
        job->action = COUNT;
        job->file = words[3];
    } else if (strcmp(words[2], "kill") == 0 && end == 4) {
        job->action = KILL;
        job->at = atol(words[3]);
    } else if (strcmp(words[2], "error") == 0 && (end == 5 || end == 6)) {
        job->action = FAIL;
        job->error = error_named(words[3]);
        job->at = atol(words[4]);
        job->on = end == 6;
    } else if (strcmp(words[2], "truncate") == 0 && end == 6) {
        job->action = CUT;
        job->file = words[3];
        job->size = (off_t)atoll(words[4]);
        job->at = atol(words[5]);
    } else {
        return 0;
    }
    return job->action != FAIL || job->error != 0;
}

int main(int argc, char **argv)
{
    struct job job;
    char **program;
    int status;
    FILE *file;

    memset(&job, 0, sizeof job);
    if (argc < 5 || !understand(argc, argv, &job, &program)) {
        fprintf(stderr,
                "usage: inject write|read|touch count FILE | error NAME K [on] | kill K | truncate FILE SIZE K -- "
                "PROGRAM ...\n");
        return 2;
    }
    status = run(&job, program);
    if (job.action == COUNT) {
        file = fopen(job.file, "w");
        if (!file || fprintf(file, "%ld\n", job.seen) < 0 || fclose(file) != 0) {
            return EXIT_UNABLE;
        }
    }
    return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}
